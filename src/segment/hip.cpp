#include "hip.h"

#include <coxa/core/error.h>
#include <coxa/segment/layer_search.h>
#include <coxa/segment/muscles.h>
#include <coxa/segment/seat.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "preparation.h"
#include "result.h"
#include "schedule.h"
#include "stages.h"

namespace coxa::segment {
namespace {

/// The unknown deformations of a bone over long and short lengths, beside what the examples leave
/// of each other.
constexpr double kLongShare = 3.0, kShortShare = 1.0;

Preparation prepared_bone(const shape::StructureModel& model) {
  const double left = std::isnan(model.leave_one_out_error) ? 0.0 : model.leave_one_out_error;
  return prepared(model, kLongShare * left, kShortShare * left);
}

}  // namespace

Hip::Hip(std::vector<PreparedImage> images, const shape::Atlas& atlas,
         const SegmentOptions& options)
    : images_(std::move(images)), atlas_(atlas), options_(options) {
  choose_models();
  for (std::size_t s = 0; s < models_.size(); ++s)
    preparations_.push_back(is_bone(s) ? prepared_bone(*models_[s]) : Preparation{});
  bodies_.resize(models_.size());
}

void Hip::choose_models() {
  // muscles lie on nothing
  std::vector<const shape::StructureModel*> firm, muscles;
  for (const shape::StructureModel& model : atlas_.structures)
    (model.muscle ? muscles : firm).push_back(&model);
  const auto hosts = find_hosts(firm);
  std::set<std::string> wanted;
  bool any_muscle = false;
  for (const std::string& name : options_.structures) {
    const shape::StructureModel& model = shape::structure(atlas_, name);
    wanted.insert(model.name);
    any_muscle = any_muscle || model.muscle;
  }
  for (std::size_t s = 0; s < firm.size(); ++s) {
    if (wanted.contains(firm[s]->name) && hosts[s]) wanted.insert(firm[*hosts[s]]->name);
    // bones carry the muscles
    if (any_muscle && !hosts[s]) wanted.insert(firm[s]->name);
  }
  for (const shape::StructureModel* model : firm) {
    if (wanted.contains(model->name)) models_.push_back(model);
  }
  hosts_ = find_hosts(models_);
  // the forces between muscles need their neighbours: all of them, whichever are asked for
  if (any_muscle) models_.insert(models_.end(), muscles.begin(), muscles.end());
  hosts_.resize(models_.size());
}

void Hip::choose_contrasts(const std::vector<Body>& bodies, Resolution resolution) {
  resolution.fit_only = true;
  for (std::size_t i = 0; i < images_.size(); ++i) {
    images_[i].contrast =
        best_contrast(bodies, std::span(images_).first(i), images_[i], resolution, options_);
  }
}

void Hip::place_layers(std::vector<Body>& layers, const std::vector<TriMesh>& means,
                       const std::vector<TriMesh>& seats, Resolution resolution) {
  resolution.range = 0.0;
  resolution.score_smoothing = 0;
  const auto smooth = smoothed_images(images_, resolution.image_sigma);
  for (std::size_t b = 0; b < layers.size(); ++b) {
    if (layers[b].model->n_bone_side == 0) continue;
    const VecX seat = layers[b].seat;
    const Points placed =
        layer_by_modes(layers[b], means[b], seats[b], smooth, resolution, options_);
    layers[b] = placed_body(*layers[b].model, placed);
    layers[b].points = placed;
    layers[b].seat = seat;
  }
}

void Hip::segment_layers(const Monitor& monitor) {
  std::vector<std::size_t> numbers;
  std::vector<Body> layers;
  std::vector<TriMesh> means, seats;
  for (std::size_t s = 0; s < models_.size(); ++s) {
    if (!hosts_[s]) continue;
    const Body& host = bodies_[*hosts_[s]];
    means.push_back(dual_surface(host.model->hierarchy.levels.back()));
    seats.push_back(surface_mesh(host));
    Body layer = placed_body(*models_[s], carried_points(models_[s]->hierarchy.levels.back().points,
                                                         means.back(), seats.back()));
    layer.seat = seated_vertices(*models_[s], means.back());
    numbers.push_back(s);
    layers.push_back(std::move(layer));
  }
  if (layers.empty()) return;
  const auto resolutions = layer_resolutions();
  choose_contrasts(layers, resolutions.front());
  place_layers(layers, means, seats, resolutions.front());
  // no layer enters any bone
  Obstacles bones;
  for (std::size_t s = 0; s < models_.size(); ++s) {
    if (is_bone(s)) bones.push_back(surface_mesh(bodies_[s]));
  }
  update_through(layers, resolutions, images_, std::vector<Obstacles>(layers.size(), bones), seats,
                 options_, monitor);
  for (std::size_t b = 0; b < layers.size(); ++b) bodies_[numbers[b]] = std::move(layers[b]);
}

void Hip::segment_muscles(const Monitor& monitor) {
  std::vector<FoundBone> bones;
  std::vector<std::size_t> numbers;
  std::vector<const shape::StructureModel*> models;
  for (std::size_t s = 0; s < models_.size(); ++s) {
    if (is_bone(s))
      bones.push_back(
          {dual_surface(models_[s]->hierarchy.levels.back()), surface_mesh(bodies_[s])});
    if (!is_muscle(s)) continue;
    numbers.push_back(s);
    models.push_back(models_[s]);
  }
  if (numbers.empty()) return;
  std::vector<Body> muscles = found_muscles(models, bones, images_, options_, monitor);
  for (std::size_t m = 0; m < muscles.size(); ++m) bodies_[numbers[m]] = std::move(muscles[m]);
}

bool Hip::is_asked_for(std::size_t s) const {
  const auto& names = options_.structures;
  return std::find(names.begin(), names.end(), models_[s]->name) != names.end();
}

}  // namespace coxa::segment
