#pragma once

#include <coxa/core/monitor.h>
#include <coxa/shape/atlas.h>
#include <coxa/shape/shape_modes.h>

#include <string>

#include "correspondence.h"

namespace coxa::shape {

struct ModelOptions {
  int n_levels = 4;
  double variance_share = 0.99;
};

/// Generic model of corresponding shapes.
/// @param mean where the mean shape lies in the atlas frame; the modes are turned along with it
StructureModel make_model(const std::string& name, const Correspondence& all,
                          const AlignedShapes& aligned, const Points& mean,
                          const ModelOptions& options, const Monitor& monitor);

}  // namespace coxa::shape
