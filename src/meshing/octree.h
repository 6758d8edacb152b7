#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <array>
#include <vector>

namespace coxa::meshing {

using GridPoint = std::array<int, 3>;

/// Cube of an octree, in units of half the finest cube's edge, so that centres are whole numbers.
struct OctreeCell {
  GridPoint low{};
  int size = 2;
  Index children = 0;  ///< first of eight; 0 for a leaf

  GridPoint centre() const { return {low[0] + size / 2, low[1] + size / 2, low[2] + size / 2}; }
};

/// A place where cubes must be finer than the shape asks for.
struct FinePlace {
  Vec3 p = Vec3::Zero();  ///< mm
  double size = 0.0;      ///< mm, > 0: largest edge of the cubes there
};

struct OctreeOptions {
  double flatness = 0.15;  ///< mm, > 0: a cube is split where the surface in it leaves its plane by
                           ///< more, or folds back
  double smallest = 0.3;   ///< mm, > 0: edge of the finest cubes
  double largest = 10.0;   ///< mm, > 0: of the largest ones that the surface passes through
  std::vector<FinePlace> fine_places = {};
};

/// Octree whose cubes follow the shape of a surface; cubes that share a face or an edge differ by a
/// factor of two at most.
class Octree {
 public:
  /// @param surface  closed, mm
  Octree(const TriMesh& surface, const OctreeOptions& options);

  /// All cubes, parents before their children; those without children are leaves.
  const std::vector<OctreeCell>& cells() const { return cells_; }
  /// The leaf that holds a point; nullptr outside the root.
  const OctreeCell* leaf_at(const GridPoint& p) const;
  Vec3 position(const GridPoint& p) const { return origin_ + unit_ * Vec3(p[0], p[1], p[2]); }
  /// Edge of the leaf that holds a point, or of the root outside of it, mm.
  double size_at(const Vec3& p) const;

 private:
  void split(Index cell);
  void refine(const TriMesh& surface, const OctreeOptions& options);
  void balance();

  Vec3 origin_ = Vec3::Zero();  ///< mm
  double unit_ = 1.0;           ///< mm
  std::vector<OctreeCell> cells_;
};

}  // namespace coxa::meshing
