#include <coxa/mesh/topology.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <algorithm>
#include <numeric>

namespace coxa {

TriMesh two_boxes() {
  TriMesh mesh = test::box();
  const TriMesh other = test::box(Vec3(5, 5, 5), Vec3(6, 6, 6));
  mesh.points.conservativeResize(16, 3);
  mesh.points.bottomRows(8) = other.points;
  mesh.triangles.conservativeResize(24, 3);
  mesh.triangles.bottomRows(12) = other.triangles.array() + 8;
  return mesh;
}
TriMesh without_triangle(TriMesh mesh, Index t) {
  mesh.triangles.row(t) = mesh.triangles.row(mesh.n_triangles() - 1);
  mesh.triangles.conservativeResize(mesh.n_triangles() - 1, 3);
  return mesh;
}

TEST(MeshEdges, ListEveryEdgeOnceWithItsTriangles) {
  const TriMesh box = test::box();
  const MeshEdges edges = mesh_edges(box);
  EXPECT_EQ(edges.vertices.rows(), 18);
  for (Index t = 0; t < box.n_triangles(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index e = edges.of_triangle(t, k), a = box.triangles(t, k),
                  b = box.triangles(t, (k + 1) % 3);
      EXPECT_EQ(edges.vertices(e, 0), std::min(a, b));
      EXPECT_EQ(edges.vertices(e, 1), std::max(a, b));
      EXPECT_EQ(edges.triangles[e].size(), 2u);
      EXPECT_EQ(std::count(edges.triangles[e].begin(), edges.triangles[e].end(), t), 1);
    }
}
TEST(Adjacency, ListsTrianglesAndNeighboursOfEachVertex) {
  const TriMesh box = test::box();
  const Adjacency triangles = vertex_triangles(box), neighbours = vertex_neighbours(box);
  EXPECT_EQ(triangles.size(), 8);
  Index sum = 0;
  for (Index v = 0; v < 8; ++v) {
    for (Index t : triangles[v]) EXPECT_TRUE((box.triangles.row(t).array() == v).any());
    EXPECT_EQ(triangles[v].size(), neighbours[v].size());  // closed: as many of both
    EXPECT_TRUE(std::is_sorted(neighbours[v].begin(), neighbours[v].end()));
    sum += static_cast<Index>(neighbours[v].size());
  }
  EXPECT_EQ(sum, 36);
}
TEST(Topology, CountsPiecesHandlesAndBorders) {
  EXPECT_EQ(genus(test::icosphere(2)), 0);
  EXPECT_EQ(genus(test::torus()), 1);
  EXPECT_EQ(genus(test::lunate_shell()), 0);
  EXPECT_EQ(genus(two_boxes()), 0);
  EXPECT_EQ(euler_characteristic(two_boxes()), 4);
  EXPECT_EQ(euler_characteristic(test::plate(0.0)), 1);
  const std::vector<Index> pieces = triangle_components(two_boxes());
  EXPECT_EQ(std::count(pieces.begin(), pieces.end(), 0), 12);
  EXPECT_EQ(std::count(pieces.begin() + 12, pieces.end(), 1), 12);
}
TEST(BoundaryLoops, RunAlongTheBorderWithTheTriangles) {
  const auto loops = boundary_loops(test::plate(0.0, 1.0, 2));
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0], (std::vector<Index>{0, 1, 2, 5, 8, 7, 6, 3}));
  EXPECT_TRUE(boundary_loops(test::box()).empty());
  EXPECT_EQ(boundary_loops(without_triangle(test::box(), 3)).front().size(), 3u);
}
TEST(BoundaryLoops, RefuseBordersThatTouch) {
  TriMesh mesh = test::plate(0.0, 1.0, 2);
  mesh.triangles.resize(2, 3);
  mesh.triangles << 0, 1, 4, 4, 5, 8;
  EXPECT_THROW(boundary_loops(mesh), Error);
}
TEST(ManifoldFault, IsEmptyForClosedSurfaces) {
  for (const TriMesh& mesh :
       {test::box(), test::torus(), test::icosphere(1), test::lunate_shell(), two_boxes()})
    EXPECT_EQ(manifold_fault(mesh), "");
}
TEST(ManifoldFault, NamesTheFaultAndThePlace) {
  TriMesh mesh = without_triangle(test::box(), 0);
  EXPECT_NE(manifold_fault(mesh).find("open at the edge from vertex 0 at (-1, -1, -1) mm"),
            std::string::npos);
  mesh = test::box();
  std::swap(mesh.triangles(4, 0), mesh.triangles(4, 1));
  EXPECT_NE(manifold_fault(mesh).find("oriented against"), std::string::npos);
  mesh = test::box();
  mesh.triangles.conservativeResize(13, 3);
  mesh.triangles.row(12) << 0, 1, 7;
  EXPECT_NE(manifold_fault(mesh).find("share the edge"), std::string::npos);
  mesh = test::box();
  mesh.points.conservativeResize(9, 3);
  mesh.points.row(8).setZero();
  EXPECT_NE(manifold_fault(mesh).find("no triangle uses vertex 8"), std::string::npos);
  mesh = two_boxes();
  mesh.triangles =
      mesh.triangles.unaryExpr([](Index v) { return v == 8  ? 7
                                                    : v > 8 ? v - 1
                                                            : v; }).eval();
  mesh.points.conservativeResize(15, 3);
  EXPECT_NE(manifold_fault(mesh).find("touch only at vertex 7"), std::string::npos);
  mesh = test::box();
  mesh.triangles(0, 0) = mesh.triangles(0, 1);
  EXPECT_NE(manifold_fault(mesh), "");
  EXPECT_NE(manifold_fault({}), "");
  EXPECT_THROW(require_closed_manifold(test::plate(0.0), "test"), Error);
  mesh.triangles(0, 0) = 8;
  EXPECT_THROW(mesh_edges(mesh), Error);
}
TEST(SubMesh, KeepsOrderAndNamesTheOldVertices) {
  const TriMesh plate = test::plate(0.0, 1.0, 2);
  const std::vector<Index> kept{6, 7};
  const SubMesh part = sub_mesh(plate, kept);
  EXPECT_EQ(part.vertex_of, (std::vector<Index>{4, 5, 7, 8}));
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(part.mesh.points.row(part.mesh.triangles(i, k)),
                plate.points.row(plate.triangles(6 + i, k)));
}

}  // namespace coxa
