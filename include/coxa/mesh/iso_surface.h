#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <array>
#include <functional>
#include <span>

namespace coxa {

/// Closed manifold surface around the samples of a regular grid that exceed `level`.
///
/// Marching tetrahedra on the Kuhn subdivision of the grid: never a hole or a non-manifold edge,
/// whatever the values. What lies beyond the grid counts as the lowest value, so that shapes cut by
/// the border are closed there. Triangles are uneven: follow with `remesh`.
/// @param size      samples along x, y, z   @param values  size[0]*size[1]*size[2], x fastest
/// @param position  grid index to mm; may be any affine map, also a mirror
/// @returns         outward oriented; vertices at linearly interpolated crossings, kept 1 % of a
/// grid edge
///                  clear of the samples so that no two coincide
/// @throws Error    bad_input if sizes and values disagree, a value is not finite, or none exceeds
/// `level`
///                  or none is below
/// Source: Payne and Toga 1990.
TriMesh iso_surface(const std::array<Index, 3>& size, std::span<const float> values, double level,
                    const std::function<Vec3(const Vec3& index)>& position);

}  // namespace coxa
