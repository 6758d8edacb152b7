#include <coxa/core/error.h>
#include <coxa/segment/lay_on_hosts.h>
#include <coxa/segment/layer_extent.h>
#include <coxa/segment/uncertainty.h>

#include <cmath>

#include "bone_border.h"
#include "hip.h"
#include "result.h"

namespace coxa::segment {
namespace {

/// mm, that cartilage may enter what it lies on without a word.
constexpr double kDeepestLeft = 0.05;

}  // namespace

std::vector<double> Hip::update_bones(std::vector<Surface>& surfaces) const {
  std::vector<BareBone> bones;
  std::vector<std::size_t> numbers;
  for (std::size_t s = 0; s < bodies_.size(); ++s) {
    if (!is_bone(s)) continue;
    numbers.push_back(s);
    bones.push_back({&surfaces[s].mesh, {}});
    for (std::size_t l = 0; l < bodies_.size(); ++l) {
      if (hosts_[l] == s) bones.back().layers.push_back(&surfaces[l].mesh);
    }
  }
  std::vector<double> blur = update_borders(bones, images_);
  for (std::size_t b = 0; b < bones.size(); ++b)
    surfaces[numbers[b]].fields["border_deviation_mm"] = std::move(bones[b].deviation);
  return blur;
}

void Hip::add_uncertainties(std::vector<Surface>& surfaces) const {
  std::vector<const Volume*> volumes;
  for (const PreparedImage& image : images_) volumes.push_back(&image.volume);
  for (std::size_t s = 0; s < bodies_.size(); ++s) {
    const auto calibration = options_.calibrations.find(models_[s]->name);
    if (calibration == options_.calibrations.end()) continue;
    auto& fields = surfaces[s].fields;
    Evidence evidence = evidence_of_place(surfaces[s].mesh, models_[s]->n_bone_side, volumes);
    evidence.confidence = fields.at("confidence");
    if (is_bone(s)) evidence.border_deviation = fields.at("border_deviation_mm");
    fields["uncertainty_mm"] = uncertainties(evidence, calibration->second);
  }
}

std::vector<Surface> Hip::surfaces(std::vector<std::string>& warnings) const {
  std::vector<Surface> surfaces;
  for (const Body& body : bodies_) surfaces.push_back(surface_of(body));
  std::vector<ExtentLayer> sided;
  std::vector<std::string> names;
  std::vector<LaidLayer> layers;
  const std::vector<double> blur = update_bones(surfaces);
  for (std::size_t s = 0; s < bodies_.size(); ++s) {
    if (!hosts_[s]) continue;
    TriMesh *layer = &surfaces[s].mesh, *host = &surfaces[*hosts_[s]].mesh;
    layers.push_back({layer, host, models_[s]->n_bone_side});
    if (models_[s]->n_bone_side == 0) continue;
    sided.push_back({layer, host, models_[s]->n_bone_side});
    names.push_back(models_[s]->name);
  }
  const std::vector<FoundExtent> found = update_extents(sided, images_, blur);
  for (std::size_t l = 0; l < sided.size(); ++l) {
    if (found[l].changed()) continue;
    const std::string why = found[l].folds ? "what the image shows would fold it"
                                           : join_text("the image tells only ",
                                                       std::lround(100.0 * found[l].separation),
                                                       " % of covered and bare bone apart");
    warnings.push_back("the rims and thickness of the " + names[l] + " are the atlas's: " + why);
  }
  const double depth = lay_on_hosts(layers, options_.minimum_gap);
  if (depth > kDeepestLeft)
    warnings.push_back(join_text("cartilage enters its neighbours by up to ", depth, " mm"));
  add_uncertainties(surfaces);
  return surfaces;
}

}  // namespace coxa::segment
