#include <coxa/meshing/bone_side.h>

#include <coxa/core/error.h>
#include <coxa/meshing/mesh_surface.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <algorithm>

namespace coxa::meshing {

std::ptrdiff_t count(const TetMesh& mesh, FacetTag tag) {
  return std::count(mesh.facet_tags.begin(), mesh.facet_tags.end(), tag);
}

Vec3 middle_of(const TetMesh& mesh, Index f) {
  return mesh.points(mesh.facets.row(f), Eigen::all).colwise().mean();
}

TEST(BoneSide, LatticeMeshOfALayerHasAllThreeSides) {
  TetMesh mesh =
      mesh_surface(test::lunate_shell(12.0, 2.0),
                   {.method = Method::lattice, .max_tets = 12000, .improvement_rounds = 1})
          .mesh;
  EXPECT_EQ(count(mesh, FacetTag::untagged), mesh.facets.rows());
  EXPECT_GT(tag_bone_side(mesh, test::icosphere(5, 11.9)), 0.0);
  std::ptrdiff_t misplaced = 0;  // but for a few where the walls of the rim begin
  for (Index f = 0; f < mesh.facets.rows(); ++f) {
    const FacetTag tag = mesh.facet_tags[static_cast<std::size_t>(f)];
    const double depth = middle_of(mesh, f).norm() - 12.0;
    misplaced += (tag == FacetTag::bone_side && depth > 0.3) ||
                 (tag == FacetTag::articular_side && depth < 1.7);
  }
  EXPECT_LT(misplaced, mesh.facets.rows() / 50);
  EXPECT_GT(count(mesh, FacetTag::bone_side), mesh.facets.rows() / 4);
  EXPECT_GT(count(mesh, FacetTag::articular_side), mesh.facets.rows() / 4);
  EXPECT_GT(count(mesh, FacetTag::rim), 20);
  EXPECT_EQ(count(mesh, FacetTag::untagged), 0);
}

TEST(BoneSide, OnlyTheAttachmentOfAThickBodyIsTagged) {
  TetMesh mesh =
      mesh_surface(test::icosphere(4, 6.0), {.max_tets = 8000, .improvement_rounds = 1}).mesh;
  const TriMesh plate = test::box(Vec3(-20, -20, -8), Vec3(20, 20, -5.9));
  const double area = tag_bone_side(mesh, plate);
  // the cap of the ball less than a millimetre above the plate, or within it: 2 pi R h
  EXPECT_NEAR(area, 2.0 * kPi * 6.0 * 1.1, 6.0);
  EXPECT_EQ(count(mesh, FacetTag::articular_side) + count(mesh, FacetTag::rim), 0);
  EXPECT_EQ(tag_bone_side(mesh, test::box(Vec3(50, 0, 0), Vec3(60, 5, 5))), 0.0);
  EXPECT_EQ(count(mesh, FacetTag::untagged), mesh.facets.rows());
  EXPECT_THROW(tag_bone_side(mesh, TriMesh{}), Error);
}

}  // namespace coxa::meshing
