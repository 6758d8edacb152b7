#pragma once

#include <coxa/geom/fits.h>
#include <coxa/segment/smooth_modes.h>
#include <coxa/shape/atlas.h>

namespace coxa::segment {

/// Most probable shape of a model, and its pose, given noisy positions of some of its vertices.
struct ModelFit {
  Points points;           ///< V×3 finest level, mm, in the frame of the targets
  Similarity pose;         ///< atlas frame -> frame of the targets
  VecX coefficients;       ///< k, in standard deviations
  double off_model = 0.0;  ///< mm, mean size of the smooth deformation that no mode describes
};

/// @param targets V×3, mm   @param weights V, >= 0; 0 where the vertex has not been seen
/// @param noise   mm, standard error of a target with weight 1
/// @param smooth  deformations allowed beside the model's own modes; null: none
ModelFit fit_model(const shape::StructureModel& model, const Points& targets, const VecX& weights,
                   double noise, const SmoothModes* smooth = nullptr);

}  // namespace coxa::segment
