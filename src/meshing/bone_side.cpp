#include <coxa/meshing/bone_side.h>

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>

#include <Eigen/Geometry>

#include <cmath>
#include <utility>

namespace coxa::meshing {
namespace {

struct FaceSums {
  double area = 0.0;
  double distance = 0.0;  // area-weighted sum, mm³
};

FaceSums sums(const TetMesh& mesh, FacetTag tag, const TriangleTree* bone) {
  FaceSums result;
  for (Index f = 0; f < static_cast<Index>(mesh.facets.rows()); ++f) {
    if (mesh.facet_tags[static_cast<std::size_t>(f)] != tag) continue;
    const Vec3 a = mesh.points.row(mesh.facets(f, 0)), b = mesh.points.row(mesh.facets(f, 1)),
               c = mesh.points.row(mesh.facets(f, 2));
    const double area = 0.5 * (b - a).cross(c - a).norm();
    result.area += area;
    if (bone != nullptr) {
      result.distance += area * std::sqrt(bone->nearest((a + b + c) / 3.0).squared_distance);
    }
  }
  require(result.area > 0.0, "mesh has no facet tagged ",
          tag == FacetTag::bone_side ? "bone_side" : "articular_side");
  return result;
}

void swap_sides(TetMesh& mesh) {
  for (FacetTag& tag : mesh.facet_tags) {
    if (tag == FacetTag::bone_side) {
      tag = FacetTag::articular_side;
    } else if (tag == FacetTag::articular_side) {
      tag = FacetTag::bone_side;
    }
  }
}

}  // namespace

FaceDistances update_bone_side(TetMesh& mesh, const TriMesh& bone) {
  require(!bone.empty(), "bone surface has no triangle");
  const TriangleTree tree(bone.points, bone.triangles);
  const FaceSums first = sums(mesh, FacetTag::bone_side, &tree);
  const FaceSums second = sums(mesh, FacetTag::articular_side, &tree);
  FaceDistances result{first.distance / first.area, second.distance / second.area};
  if (result.bone_side > result.articular_side) {
    swap_sides(mesh);
    std::swap(result.bone_side, result.articular_side);
  }
  return result;
}

void update_bone_side(TetMesh& mesh, BoneFace face) {
  const double bone_area = sums(mesh, FacetTag::bone_side, nullptr).area;
  const double articular_area = sums(mesh, FacetTag::articular_side, nullptr).area;
  const bool bone_is_smaller = bone_area < articular_area;
  if (bone_is_smaller != (face == BoneFace::concave)) swap_sides(mesh);
}

}  // namespace coxa::meshing
