#include <coxa/segment/segment.h>

#include <coxa/core/error.h>
#include <coxa/segment/placement.h>
#include <coxa/segment/share_tissue.h>

#include <algorithm>
#include <cmath>

#include "hip.h"
#include "result.h"
#include "signal_void.h"

namespace coxa::segment {
namespace {

void check(const SegmentOptions& options) {
  require(!options.structures.empty(), "no structure is asked for");
  require(options.landmark_error >= 0.0, "landmark_error must be at least 0 mm, got ",
          options.landmark_error);
  require(options.search_range > 0.0, "search_range must be positive, got ", options.search_range,
          " mm");
  require(options.gradient_weight >= 0.0, "gradient_weight must be at least 0, got ",
          options.gradient_weight);
  require(options.minimum_gap >= 0.0, "minimum_gap must be at least 0 mm, got ",
          options.minimum_gap);
  require(options.iterations >= 1, "iterations must be at least 1, got ", options.iterations);
  require(options.tolerance >= 0.0, "tolerance must be at least 0 mm, got ", options.tolerance);
  require(options.minimum_quality >= 0.0 && options.minimum_quality <= 1.0,
          "minimum_quality must be in [0, 1], got ", options.minimum_quality);
  const ForceWeights& w = options.weights;
  require(std::min({w.image, w.shape, w.smoothing, w.memory, w.contact}) >= 0.0,
          "the force weights must be at least 0");
}

/// A structure's confidence below which the caller is warned; a good fit has 0.6 to 0.9.
constexpr double kLowConfidence = 0.4;
/// A quality below which the whole hip is doubtful; adults in fair images have 0.55 to 0.7.
constexpr double kDoubtfulQuality = 0.5;

/// ml. Bones with so much inside that gives no signal were never met without metal in them.
constexpr double kLargestVoid = 0.3;

void warn_of_metal(const Hip& hip, const std::vector<Surface>& surfaces,
                   std::vector<std::string>& warnings) {
  std::vector<TriMesh> bones;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (hip.is_bone(s)) bones.push_back(surfaces[s].mesh);
  }
  const double dark = signal_void(bones, hip.images());
  if (dark < kLargestVoid) return;
  warnings.push_back(join_text("low confidence: ", dark,
                               " ml inside the bones give no signal to 6 mm around, as by metal; "
                               "what lies about them is the shape model's"));
}

/// From each landmark to the atlas' own, at the pose of the bone that brings it nearest.
std::map<std::string, double> landmark_distances(const Hip& hip, const shape::Atlas& atlas,
                                                 const shape::Landmarks& landmarks) {
  std::map<std::string, double> distances;
  for (const auto& [name, place] : landmarks) {
    double nearest = kInfinity;
    for (std::size_t s = 0; s < hip.bodies().size(); ++s) {
      if (!hip.is_bone(s)) continue;
      const Similarity& pose = hip.bodies()[s].fit.pose;
      const Vec3 own = pose.X * (pose.scale * atlas.landmarks.at(name));
      nearest = std::min(nearest, (own - place).norm());
    }
    distances[name] = nearest;
  }
  return distances;
}

/// Muscles take the tissue that the image shows; none is in another, nor in a bone or cartilage.
void finish_muscles(const Hip& hip, std::vector<Surface>& surfaces,
                    std::vector<std::string>& warnings, const Monitor& monitor) {
  if (!hip.has_muscles()) return;
  std::vector<Separable> muscles;
  std::vector<const TriMesh*> firm;
  std::vector<TriMesh> bones;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const Body& body = hip.bodies()[s];
    if (hip.is_muscle(s)) {
      muscles.push_back({body.model->name, &surfaces[s], quality_of(body).correlation});
      continue;
    }
    firm.push_back(&surfaces[s].mesh);
    if (hip.is_bone(s)) bones.push_back(surfaces[s].mesh);
  }
  for (std::string& text :
       update_to_tissue(std::move(muscles), firm, bones, hip.images().front(), monitor))
    warnings.push_back(std::move(text));
}

SegmentResult make_result(const Hip& hip, Side side, const SegmentOptions& options,
                          const Monitor& monitor) {
  SegmentResult result;
  double bone_confidence = 0.0, n_bones = 0.0;
  std::string muscles_cut;
  std::vector<Surface> surfaces = hip.surfaces(result.warnings);
  finish_muscles(hip, surfaces, result.warnings, monitor);
  for (std::size_t s = 0; s < hip.bodies().size(); ++s) {
    const Body& body = hip.bodies()[s];
    const StructureQuality quality = quality_of(body);
    result.structures[body.model->name] = quality;
    if (hip.is_bone(s)) {
      bone_confidence += quality.confidence;
      n_bones += 1.0;
    }
    if (!hip.is_asked_for(s)) continue;
    if (quality.confidence < kLowConfidence) {
      result.warnings.push_back(
          join_text(body.model->name, " was found with low confidence, ", quality.confidence));
    }
    const Surface& surface = surfaces[s];
    result.surfaces[body.model->name] = side == Side::left ? mirrored(surface) : surface;
    if (hip.is_muscle(s) && quality.in_view < 0.5) {
      muscles_cut += (muscles_cut.empty() ? "" : ", ") + body.model->name;
    } else if (quality.in_view < 0.5) {
      result.warnings.push_back(join_text("only ", std::lround(100.0 * quality.in_view), " % of ",
                                          body.model->name,
                                          " is in view; the rest is the shape model's"));
    }
  }
  if (!muscles_cut.empty()) {
    result.warnings.push_back("less than half is in view of " + muscles_cut +
                              "; the rest is the shape model's");
  }
  warn_of_metal(hip, surfaces, result.warnings);
  result.quality = n_bones > 0.0 ? bone_confidence / n_bones : 1.0;
  if (result.quality < kDoubtfulQuality) {
    result.warnings.push_back(join_text(
        "low confidence: quality ", result.quality, ", below ", kDoubtfulQuality,
        "; the hip may lie outside the atlas, which is made of adults without prostheses"));
  }
  for (const PreparedImage& image : hip.images()) result.contrasts.push_back(image.contrast);
  if (result.quality < options.minimum_quality) {
    fail(ErrorCode::below_quality, "the hip was not found: quality ", result.quality,
         " is below the least allowed, ", options.minimum_quality,
         "; check side, landmarks and that the hip is in the image");
  }
  return result;
}

}  // namespace

SegmentResult segment(const std::vector<Volume>& volumes, const shape::Atlas& atlas, Side side,
                      const shape::Landmarks& landmarks, const SegmentOptions& options,
                      const Monitor& monitor) {
  check(options);
  require(!volumes.empty(), "there is no image to segment");
  std::vector<PreparedImage> images;
  for (const Volume& volume : volumes) {
    images.push_back(prepare_image(side == Side::left ? mirrored(volume) : volume,
                                   options.correct_bias, monitor));
  }
  shape::Landmarks ours = landmarks_of_side(landmarks, atlas, side);
  if (side == Side::left) ours = mirrored(ours);
  Hip hip(std::move(images), atlas, options);
  const double bones_and_layers = hip.has_muscles() ? 0.5 : 1.0;
  hip.segment_bones(ours, part_of(monitor, "segment bones", 0.0, 0.7 * bones_and_layers));
  hip.segment_layers(
      part_of(monitor, "segment cartilages", 0.7 * bones_and_layers, bones_and_layers));
  hip.segment_muscles(part_of(monitor, "segment muscles", bones_and_layers, 1.0));
  SegmentResult result = make_result(hip, side, options, monitor);
  result.landmark_distances = landmark_distances(hip, atlas, ours);
  return result;
}

}  // namespace coxa::segment
