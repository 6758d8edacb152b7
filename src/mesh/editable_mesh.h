#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <array>
#include <optional>
#include <vector>

namespace coxa {

/// Closed manifold triangulation under local changes, each of which keeps it closed and manifold.
class EditableMesh {
 public:
  using Triangle = std::array<Index, 3>;

  /// @param mesh closed, oriented, manifold (checked by the caller)
  explicit EditableMesh(const TriMesh& mesh);

  Index n_vertices() const { return static_cast<Index>(points_.size()); }  ///< dead ones included
  Index n_triangles() const { return n_alive_; }
  bool alive(Index v) const { return !around_[static_cast<std::size_t>(v)].empty(); }
  const Vec3& point(Index v) const { return points_[static_cast<std::size_t>(v)]; }
  void move(Index v, const Vec3& p) { points_[static_cast<std::size_t>(v)] = p; }
  const std::vector<Index>& around(Index v) const { return around_[static_cast<std::size_t>(v)]; }
  const Triangle& triangle(Index t) const { return triangles_[static_cast<std::size_t>(t)]; }
  Index degree(Index v) const { return static_cast<Index>(around(v).size()); }

  /// Neighbours of v, ascending.
  std::vector<Index> neighbours(Index v) const;
  /// Every edge (a, b), a < b, ascending.
  std::vector<std::array<Index, 2>> edges() const;
  /// The two vertices opposite edge ab: left of a -> b first.
  std::array<Index, 2> opposite(Index a, Index b) const;
  Vec3 area_vector(Index t) const;    ///< half the cross product
  Vec3 vertex_normal(Index v) const;  ///< unit, area-weighted

  /// Whether merging b into a at p keeps the surface manifold and turns no triangle over.
  bool can_collapse(Index a, Index b, const Vec3& p) const;
  void collapse(Index a, Index b, const Vec3& p);
  /// New vertex at p on edge ab.
  Index split(Index a, Index b, const Vec3& p);
  /// Whether edge ab can become the other diagonal of its two triangles without folding.
  bool can_flip(Index a, Index b) const;
  void flip(Index a, Index b);
  /// Whether moving v to p turns no triangle over.
  bool can_move(Index v, const Vec3& p) const;

  /// The mesh without dead vertices and triangles.
  TriMesh result() const;

 private:
  bool turns_over(Index t, Index v, const Vec3& p) const;
  void replace(Index t, Index from, Index to);
  void detach(Index v, Index t);

  std::vector<Vec3> points_;
  std::vector<Triangle> triangles_;  ///< dead ones name vertex 0 three times
  std::vector<std::vector<Index>> around_;
  Index n_alive_ = 0;
};

}  // namespace coxa
