#include <coxa/mesh/vertex_normals.h>

#include <coxa/core/parallel.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa {

TEST(VertexNormals, OfASpherePointAlongTheRadius) {
  const TriMesh sphere = test::icosphere(4);
  EXPECT_LE((vertex_normals(sphere) - sphere.points / 10.0).rowwise().norm().maxCoeff(), 5e-3);
}
TEST(VertexNormals, AtABoxCornerDoNotDependOnTheDiagonals) {
  const TriMesh box = test::box();
  EXPECT_LE((vertex_normals(box) - box.points / std::sqrt(3.0)).rowwise().norm().maxCoeff(), 1e-14);
}
TEST(VertexNormals, TurnWithTheMesh) {
  const TriMesh mesh = test::lunate_shell();
  const Points turned = vertex_normals(test::moved(mesh, test::some_pose()));
  EXPECT_LE((turned - vertex_normals(mesh) * test::some_pose().R.transpose()).cwiseAbs().maxCoeff(),
            1e-12);
}
TEST(VertexNormals, AreZeroAtUnusedVerticesAndIgnoreTrianglesWithoutArea) {
  TriMesh mesh = test::plate(0.0, 1.0, 1);
  mesh.points.conservativeResize(5, 3);
  mesh.points.row(4) << 9, 9, 9;
  mesh.triangles.conservativeResize(3, 3);
  mesh.triangles.row(2) << 0, 1, 1;
  EXPECT_EQ(Vec3(vertex_normals(mesh).row(4)), Vec3::Zero());
  EXPECT_EQ(Vec3(vertex_normals(mesh).row(1)), Vec3::UnitZ());
}
TEST(VertexNormals, AreBitIdenticalForOneAndEightThreads) {
  const TriMesh mesh = test::torus();
  EXPECT_EQ(with_threads(1, [&] { return vertex_normals(mesh); }),
            with_threads(8, [&] { return vertex_normals(mesh); }));
}
TEST(TriangleNormals, AreOutwardUnitVectors) {
  const Points normals = triangle_normals(test::box());
  EXPECT_EQ(Vec3(normals.row(0)), -Vec3::UnitZ());
  EXPECT_EQ(Vec3(normals.row(11)), Vec3::UnitX());
}

}  // namespace coxa
