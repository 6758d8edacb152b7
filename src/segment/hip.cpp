#include "hip.h"

#include <coxa/core/error.h>
#include <coxa/segment/cortex_search.h>
#include <coxa/segment/layer_search.h>
#include <coxa/segment/muscles.h>
#include <coxa/segment/placement.h>
#include <coxa/segment/pose_search.h>
#include <coxa/segment/seat.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "landmark_reach.h"
#include "preparation.h"
#include "result.h"
#include "schedule.h"
#include "stages.h"

namespace coxa::segment {
namespace {

/// So many landmarks are in the image at least; others may have been set in another of the patient.
constexpr int kLeastInImage = 3;

void check_in_image(const std::vector<PreparedImage>& images, const shape::Landmarks& landmarks) {
  const auto inside = std::count_if(landmarks.begin(), landmarks.end(), [&](const auto& landmark) {
    return std::any_of(images.begin(), images.end(), [&](const PreparedImage& image) {
      return in_view(image.volume, landmark.second);
    });
  });
  require(landmarks.empty() || inside >= kLeastInImage, "only ", inside, " of ", landmarks.size(),
          " known landmarks lie in the image, and ", kLeastInImage,
          " is the least; they belong to another image, or to another frame than LPS");
}

Body placed_body(const shape::StructureModel& model, Points placed) {
  Body body;
  body.model = &model;
  body.fit = fit_model(model, placed, VecX::Ones(placed.rows()), 1.0);
  body.points = body.fit.points;
  return body;
}

/// The unknown deformations of a bone over long and short lengths, beside what the examples leave
/// of each other.
constexpr double kLongShare = 3.0, kShortShare = 1.0;

Preparation prepared_bone(const shape::StructureModel& model) {
  const double left = std::isnan(model.leave_one_out_error) ? 0.0 : model.leave_one_out_error;
  return prepared(model, kLongShare * left, kShortShare * left);
}

/// Landmarks placed on slices are as exact as these are thin: borders are looked for at least this
/// many voxels away.
constexpr double kVoxelsSearched = 3.0;

/// mm, of the image with the thinnest slices.
double thinnest_slice(const std::vector<PreparedImage>& images) {
  double thinnest = kInfinity;
  for (const PreparedImage& image : images)
    thinnest = std::min(thinnest, image.volume.spacing.maxCoeff());
  return thinnest;
}

/// A bone's confidence below which it is looked for twice more, in a narrower search (share of the
/// usual range): from the same start, and from where dark lines inside it lie.
constexpr double kDoubtfulBone = 0.65, kNarrowShare = 2.0 / 3.0;
/// mm, of the places where dark lines lie.
constexpr double kDrawnNoise = 1.0;

double mean_confidence(const std::vector<Body>& bodies) {
  double sum = 0.0;
  for (const Body& body : bodies) sum += quality_of(body).confidence;
  return sum / static_cast<double>(bodies.size());
}

/// Bones of two searches whose mean confidences differ by less are equally well found.
constexpr double kClearlyBetter = 0.01;

/// Takes other bones that are clearly better found on the whole. (The better of each would not fit
/// each other: in one search they keep out of each other.)
void update_best(std::vector<Body>& best, std::vector<Body> others) {
  if (mean_confidence(others) > mean_confidence(best) + kClearlyBetter) best = std::move(others);
}

bool any_doubtful(const std::vector<Body>& bodies) {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& body) { return quality_of(body).confidence < kDoubtfulBone; });
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

std::vector<Body> Hip::found_by(const std::vector<Resolution>& resolutions, std::vector<Body> bones,
                                const Monitor& monitor) const {
  update_through(bones, resolutions, images_, std::vector<Obstacles>(bones.size()),
                 std::vector<TriMesh>(bones.size()), options_, monitor);
  return bones;
}

void Hip::segment_bones(const shape::Landmarks& landmarks, const Monitor& monitor) {
  std::vector<std::size_t> numbers;
  std::vector<const shape::StructureModel*> models;
  for (std::size_t s = 0; s < models_.size(); ++s) {
    if (!is_bone(s)) continue;
    numbers.push_back(s);
    models.push_back(models_[s]);
  }
  std::vector<Body> bones;
  const std::vector<Points> placed =
      landmarks.empty() ? find_pose(models, images_, options_, monitor).placed
                        : place_by_landmarks(models, landmarks, atlas_, options_.landmark_error);
  check_in_image(images_, landmarks);
  for (std::size_t b = 0; b < models.size(); ++b) {
    bones.push_back(placed_body(*models[b], placed[b]));
    bones.back().prepared = &preparations_[numbers[b]];
    bones.back().reach =
        reach_to_far_end(reach_of(*models[b], landmarks, atlas_), bones.back().points, images_);
    update_any_kind_beyond(preparations_[numbers[b]], bones.back().reach);
  }
  const double slice = thinnest_slice(images_);
  const double wide = std::max(options_.search_range, kVoxelsSearched * slice);
  choose_contrasts(bones, bone_resolutions(wide).front());
  std::vector<Body> best =
      found_by(bone_resolutions(wide), bones, part_of(monitor, "segment", 0.0, 0.5));
  // too wide a search may take another border for the bone's; in slices thicker than the usual
  // range nothing nearer can be asked for
  const bool thick = slice > options_.search_range;
  if (wide > options_.search_range && !thick)
    update_best(best, found_by(bone_resolutions(options_.search_range), bones,
                               part_of(monitor, "segment", 0.5, 0.75)));
  if (any_doubtful(best) && !thick) {
    auto narrow = bone_resolutions(kNarrowShare * options_.search_range);
    update_best(best, found_by(narrow, bones, part_of(monitor, "segment", 0.75, 0.85)));
    for (std::size_t b = 0; b < bones.size(); ++b) {
      bones[b].fit = fit_model(*models[b], drawn_to_cortex(best[b], images_),
                               VecX::Ones(bones[b].points.rows()), kDrawnNoise,
                               &preparations_[numbers[b]].smooth);
      bones[b].points = bones[b].fit.points;
    }
    // without the first, which would take the smooth deformations out again
    narrow.erase(narrow.begin());
    update_best(best, found_by(narrow, bones, part_of(monitor, "segment", 0.85, 1.0)));
  }
  for (std::size_t b = 0; b < bones.size(); ++b) bodies_[numbers[b]] = std::move(best[b]);
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
