#include <coxa/meshing/bone_side.h>

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/vertex_normals.h>

#include <Eigen/Geometry>

#include <cmath>
#include <utility>
#include <vector>

namespace coxa::meshing {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

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

double tag_bone_side(TetMesh& mesh, const TriMesh& bone) {
  constexpr double kAttached = 1.0;  // mm, less than cartilage is thick
  constexpr double kLooks = 0.5;     // cosine between the normals
  constexpr double kLayer = 0.25;    // of the boundary's area
  require(!bone.empty(), "bone surface has no triangle");
  const TriangleTree tree(bone.points, bone.triangles);
  const Points bone_normals = triangle_normals(bone);
  const TriMesh boundary{mesh.points, mesh.facets};
  const Points normals = triangle_normals(boundary);
  const VecX areas = triangle_areas(boundary);
  std::vector<FacetTag> tags(at(mesh.facets.rows()), FacetTag::rim);
  double on_bone = 0.0;
  for (Index f = 0; f < mesh.facets.rows(); ++f) {
    const Vec3 middle = mesh.points(mesh.facets.row(f), Eigen::all).colwise().mean();
    const NearestPoint near = tree.nearest(middle);
    const double along = normals.row(f).dot(bone_normals.row(near.triangle));
    if (along > kLooks) tags[at(f)] = FacetTag::articular_side;
    if (along < -kLooks && near.squared_distance <= kAttached * kAttached) {
      tags[at(f)] = FacetTag::bone_side;
      on_bone += areas[f];
    }
  }
  const bool layer = on_bone >= kLayer * areas.sum();
  for (FacetTag& tag : tags)
    if (!layer && tag != FacetTag::bone_side) tag = FacetTag::untagged;
  mesh.facet_tags = std::move(tags);
  return on_bone;
}

void update_bone_side(TetMesh& mesh, BoneFace face) {
  const double bone_area = sums(mesh, FacetTag::bone_side, nullptr).area;
  const double articular_area = sums(mesh, FacetTag::articular_side, nullptr).area;
  const bool bone_is_smaller = bone_area < articular_area;
  if (bone_is_smaller != (face == BoneFace::concave)) swap_sides(mesh);
}

}  // namespace coxa::meshing
