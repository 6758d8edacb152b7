#pragma once

#include <coxa/core/types.h>

#include <array>
#include <cstdint>
#include <vector>

namespace coxa::meshing {

using Tet = std::array<Index, 4>;

/// Where a node may move.
enum class NodeKind : std::int8_t {
  inside,         ///< anywhere
  first_face,     ///< on the first face of the sheet (or the whole surface of a solid)
  second_face,    ///< on the second face
  rim_band,       ///< on the rim band between the faces
  rim_edge,       ///< on the (rounded) knife edge where both faces meet
  first_border,   ///< on the border between first face and rim band
  second_border,  ///< on the border between second face and rim band
  fixed
};

/// Tetrahedra under edition: positions, where nodes may move, and who is around each node.
struct TetGrid {
  std::vector<Vec3> x;  ///< mm
  std::vector<NodeKind> kinds;
  std::vector<double> levels;              ///< 0 on the first face, number of layers on the second
  std::vector<Tet> tets;                   ///< positive volume; removed ones have tet[0] < 0
  std::vector<std::vector<Index>> around;  ///< living tets of each node, ascending order not kept

  bool alive(Index t) const { return tets[static_cast<std::size_t>(t)][0] >= 0; }
  Index add(const Tet& tet);
  void remove(Index t);
  void link();  ///< rebuilds `around` and drops removed tets
};

/// Six times the volume of the tetrahedron.
double volume6(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace coxa::meshing
