#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace coxa {

/// Which samples of a regular grid lie inside a closed, outward surface: 1 inside, 0 outside; x
/// fastest.
///
/// Per grid row the surface's crossings are sorted and counted with their direction, so the cost is
/// that of projecting the triangles once plus the inside samples. Bodies that overlap count as one.
/// @param index  mm to grid index; any affine map of the grid's frame (also mirrored)
std::vector<std::uint8_t> inside_samples(const TriMesh& mesh, const std::array<Index, 3>& size,
                                         const std::function<Vec3(const Vec3& position)>& index);

}  // namespace coxa
