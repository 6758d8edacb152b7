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
  first_crease,   ///< on a sharp bend of the first face
  second_crease,  ///< on a sharp bend of the second face
  second_border,  ///< on the border between second face and rim band
  first_corner,   ///< stays: corner of the first face's border
  second_corner,  ///< stays: corner of the second face's border
  rim_corner      ///< stays: corner of a knife edge
};

/// Whether a node belongs to the first face, its border included.
constexpr bool on_first_face(NodeKind k) {
  return k == NodeKind::first_face || k == NodeKind::first_border || k == NodeKind::first_crease ||
         k == NodeKind::first_corner;
}
constexpr bool on_second_face(NodeKind k) {
  return k == NodeKind::second_face || k == NodeKind::second_border ||
         k == NodeKind::second_crease || k == NodeKind::second_corner;
}
constexpr bool is_fixed(NodeKind k) {
  return k == NodeKind::first_corner || k == NodeKind::second_corner || k == NodeKind::rim_corner;
}

/// Tetrahedra under edition: positions, where nodes may move, and who is around each node.
struct TetGrid {
  std::vector<Vec3> x;  ///< mm
  std::vector<NodeKind> kinds;
  std::vector<double> levels;  ///< 0 on the first face, number of layers on the second
  std::vector<double> reach;   ///< mm: how far a node may leave where its kind keeps it, mostly 0
  std::vector<Tet> tets;       ///< positive volume; removed ones have tet[0] < 0
  std::vector<std::vector<Index>> around;  ///< living tets of each node, ascending order not kept

  bool alive(Index t) const { return tets[static_cast<std::size_t>(t)][0] >= 0; }
  std::ptrdiff_t n_living() const;
  Index add(const Tet& tet);
  void remove(Index t);
  void link();  ///< rebuilds `around` and drops removed tets
};

/// Six times the volume of the tetrahedron.
double volume6(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace coxa::meshing
