#pragma once

#include <coxa/core/monitor.h>
#include <coxa/image/volume.h>
#include <coxa/mesh/surface_set.h>
#include <coxa/segment/uncertainty.h>
#include <coxa/shape/atlas.h>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace coxa::segment {

/// Weights of the forces that act on a deforming mesh; all in units of the external force of a
/// vertex whose profile fits perfectly. Each may be 0 (the force is absent).
struct ForceWeights {
  double image = 1.0;      ///< profile matching
  double shape = 0.3;      ///< statistical shape: pull to the fit of the point distribution model
  double smoothing = 1.0;  ///< simplex angle: its deviation from the model's varies slowly
  double memory = 0.5;     ///< simplex parameters: local form stays the model's
  double contact = 20.0;   ///< non-penetration, and cartilage on its bone
};

struct SegmentOptions {
  /// What to segment; bones come before the cartilages that lie on them, whatever the order here.
  std::vector<std::string> structures = {"femur", "hip_bone", "femoral_cartilage",
                                         "acetabular_cartilage"};
  double landmark_error = 3.0;  ///< mm, expected standard error of a landmark, >= 0
  double search_range =
      6.0;  ///< mm, how far from its start a border is looked for at the coarsest level, > 0
  ForceWeights weights = {};
  double gradient_weight =
      0.3;                    ///< of the border's gradient beside the profile's correlation, >= 0
  double minimum_gap = 0.02;  ///< mm, kept between structures, >= 0
  int iterations = 12;        ///< largest number at each resolution, >= 1
  double tolerance =
      0.02;  ///< mm, mean move of an iteration below which a resolution is finished, >= 0
  bool correct_bias = true;  ///< take a slow field of brightness out of each image first
  std::optional<std::string> contrast =
      {};                        ///< the atlas' profiles to use; none: the best fitting of them
  double minimum_quality = 0.4;  ///< in [0, 1]: below it the result is refused with below_quality
  /// By structure: how wide its 95 % intervals are. A structure without one gets no uncertainty_mm.
  std::map<std::string, Calibration> calibrations = {};
  /// Called now and then with the surfaces as far as they are found; changes nothing.
  std::function<void(const SurfaceSet&)> on_found = {};
};

/// How well one structure was found.
struct StructureQuality {
  double correlation =
      0.0;  ///< mean, in view, of the correlation of image and reference profiles, [-1, 1]
  double residual = 0.0;    ///< mm, mean in view of the distance still asked for by the image
  double in_view = 0.0;     ///< share of the vertices inside the image
  double confidence = 0.0;  ///< [0, 1], from the three
};

struct SegmentResult {
  /// Closed surfaces, LPS mm, with fields `confidence` ([0, 1]) and `completed` (1 outside the
  /// view: the shape model's opinion, 0 seen in the image); where the options have a calibration
  /// `uncertainty_mm` (half width of the 95 % interval of the distance from the true surface).
  /// Bones have `border_deviation_mm` (BareBone).
  SurfaceSet surfaces;
  std::map<std::string, StructureQuality> structures;
  std::map<std::string, double>
      landmark_distances;              ///< mm, from each given landmark to the model's own
  std::vector<std::string> contrasts;  ///< per volume, the atlas' contrast its profiles fitted best
  double quality = 0.0;                ///< [0, 1], the mean confidence of the bones
  std::vector<std::string> warnings;
};

/// Finds the structures of one hip in one or more images of the same patient in the same position.
///
/// Landmarks place the atlas by a thin-plate spline; 2-simplex meshes, coarse to fine, then move as
/// particles under image, shape and contact forces with backward Euler steps, bones first,
/// cartilages on them after.
/// @param landmarks  LPS mm, by name with or without the suffix `_left` / `_right`; at least six
/// known to the
///                   atlas, or none at all: then the hip is looked for in the image
/// @throws Error bad_input if there is no image, an option is out of range, landmarks are too few,
/// on the other
///         side, or not near the image; below_quality if the hip is not in the image
/// @note   bit-identical for any number of threads
/// Source: Gilles and Magnenat-Thalmann 2010; Schmid et al. 2011 (partial view); docs/segment.md
SegmentResult segment(const std::vector<Volume>& volumes, const shape::Atlas& atlas, Side side,
                      const shape::Landmarks& landmarks, const SegmentOptions& options = {},
                      const Monitor& monitor = {});

}  // namespace coxa::segment
