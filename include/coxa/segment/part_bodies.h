#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::segment {

/// How overlaps are parted, mm.
struct Parting {
  double gap = 0.1;  ///< kept between surfaces, so that flat triangles do not cross between the
                     ///< points looked at
  double tolerance = 0.02;  ///< no deeper than this
  double deepest = 3.0;  ///< what is deeper is no overlap of neighbours but a body in a wrong place
  double reach = 20.0;   ///< deeper points are not looked for
  double near = 2.0;     ///< points this near are looked at in every round
};

/// A closed surface that gives way.
struct SoftBody {
  TriMesh* mesh = nullptr;
  /// Of a layer: its first triangles, that lie on a firm body; triangle i + n_bone_side lies
  /// opposite triangle i. What pushes one side off a firm body takes the other along, so that thin
  /// rims neither fold nor thin out. 0: no layer
  Index n_bone_side = 0;
};

/// Parts soft closed surfaces that enter each other, or firm ones, until none is deeper than the
/// tolerance or it does not help any more: soft ones share the way, firm ones stay.
///
/// What is deeper than `Parting::deepest` stays there: it is only reported. Where a surface would
/// fold it stays as it was. A lattice of points on each triangle is looked for in all others.
/// @returns the greatest depth of such a point that is left, mm; 0 where none is inside
/// @note bit-identical for any number of threads
double update_parted(const std::vector<SoftBody>& soft, const std::vector<const TriMesh*>& firm,
                     const Parting& parting = {}, const Monitor& monitor = {});

}  // namespace coxa::segment
