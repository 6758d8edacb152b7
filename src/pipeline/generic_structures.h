#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/surface_set.h>
#include <coxa/pipeline/record.h>
#include <coxa/shape/atlas.h>

#include <string>
#include <vector>

namespace coxa::pipeline {

/// What of `wanted` is generic.
std::vector<std::string> generic_among(const std::vector<std::string>& wanted);

/// Makes labrum and ligaments on the bones and cartilages at hand, each with the fields `generic`
/// 1, `completed` 1 and `confidence` 0.
///
/// What cannot be made is left out with a warning in the record; so is said that they are generic.
/// @param surfaces  femur, hip bone and both cartilages of one hip, LPS mm; what is made is added
/// @param atlas     whose model the femur is, vertex by vertex: its landmarks say where ligaments
///                  end; nullptr, or another triangulation: they are found on the femur itself
void add_generic(SurfaceSet& surfaces, const std::vector<std::string>& wanted, Side side,
                 const shape::Atlas* atlas, Record& record, const Monitor& monitor);

}  // namespace coxa::pipeline
