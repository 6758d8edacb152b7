#include <coxa/mesh/remesh.h>

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/iso_surface.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa {

double largest_distance(const TriMesh& from, const TriMesh& to) {
  const TriangleTree tree(to.points, to.triangles);
  double largest = 0.0;
  for (Index v = 0; v < from.n_vertices(); ++v)
    largest = std::max(largest, std::sqrt(tree.nearest(from.points.row(v)).squared_distance));
  return largest;
}
// edges whose length lies in [low, high], as a share
double share_of_edges(const TriMesh& mesh, double low, double high) {
  const MeshEdges edges = mesh_edges(mesh);
  Index inside = 0;
  for (Index e = 0; e < edges.vertices.rows(); ++e) {
    const double length =
        (mesh.points.row(edges.vertices(e, 0)) - mesh.points.row(edges.vertices(e, 1))).norm();
    inside += length >= low && length <= high;
  }
  return double(inside) / static_cast<double>(edges.vertices.rows());
}
TriMesh iso_torus() {
  const std::array<Index, 3> size{40, 40, 16};
  std::vector<float> values;
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i) {
        const double ring = std::hypot(i - 19.5, j - 19.5) - 13.0;
        values.push_back(static_cast<float>(4.3 - std::hypot(ring, k - 7.5)));
      }
  return iso_surface(size, values, 0.0, [](const Vec3& p) { return p; });
}

TEST(Decimate, ReachesTheCountAndKeepsShapeAndTopology) {
  const TriMesh torus = test::torus(10.0, 3.0, 96, 48);
  for (double evenness : {0.0, 0.1}) {
    const TriMesh coarse = decimate(torus, {.n_triangles = 1000, .evenness = evenness});
    EXPECT_EQ(coarse.n_triangles(), 1000);
    EXPECT_EQ(genus(coarse), 1);
    EXPECT_NEAR(volume(coarse), volume(torus), 0.02 * volume(torus));
    EXPECT_LE(largest_distance(coarse, torus), 0.15);
  }
}
TEST(Decimate, KeepsTheShapeOfABox) {
  const TriMesh fine = [] {
    TriMesh mesh =
        remesh(test::box(Vec3(-4, -5, -6), Vec3(4, 5, 6)), {.target_edge = 1.0, .iterations = 1});
    return mesh;
  }();
  const TriMesh cube = decimate(fine, {.n_triangles = 60});
  EXPECT_GT(fine.n_triangles(), 500);
  EXPECT_NEAR(volume(cube), volume(fine), 0.01 * volume(fine));
}
TEST(Decimate, EvennessEvensTheTriangles) {
  // a long cylinder with round ends: shape alone makes long triangles along it
  TriMesh pill = test::icosphere(4, 5.0);
  pill.points.col(2) =
      pill.points.col(2).unaryExpr([](double z) { return z + (z > 0 ? 20.0 : -20.0); });
  pill = remesh(pill, {.target_edge = 1.2, .iterations = 4});
  const double edge = edge_length_for(pill, 600);
  const double shape = share_of_edges(decimate(pill, {.n_triangles = 600}), 0.6 * edge, 1.5 * edge);
  const double even =
      share_of_edges(decimate(pill, {.n_triangles = 600, .evenness = 0.1}), 0.6 * edge, 1.5 * edge);
  EXPECT_GT(even, 0.93);
  EXPECT_GT(even, shape);
}
TEST(Decimate, LeavesKeptVerticesWhereTheyAre) {
  const TriMesh ball = test::icosphere(4, 5.0);
  std::vector<bool> kept(static_cast<std::size_t>(ball.n_vertices()), false);
  for (Index v = 0; v < ball.n_vertices(); ++v)
    kept[static_cast<std::size_t>(v)] = ball.points(v, 2) > 3.0;
  const TriMesh fewer = decimate(ball, {.n_triangles = 1000, .kept = kept});
  for (Index v = 0; v < ball.n_vertices(); ++v)
    if (kept[static_cast<std::size_t>(v)]) {
      EXPECT_EQ((fewer.points.rowwise() - ball.points.row(v)).rowwise().norm().minCoeff(), 0.0);
    }
  EXPECT_LT(fewer.n_triangles(), ball.n_triangles() / 2);
}
TEST(Decimate, StopsAtTheLastManifoldAndKeepsItClosed) {
  const TriMesh tiny = decimate(test::icosphere(2), {.n_triangles = 4});
  EXPECT_EQ(manifold_fault(tiny), "");
  EXPECT_LT(tiny.n_triangles(), 40);
}
TEST(Decimate, IsOnlyAsGoodAsItsInput) {
  EXPECT_THROW(decimate(test::plate(0.0), {.n_triangles = 10}), Error);
  EXPECT_THROW(decimate(test::box(), {.n_triangles = 3}), Error);
  EXPECT_THROW(decimate(test::box(), {.n_triangles = 8, .evenness = -1.0}), Error);
  EXPECT_THROW(decimate(test::box(), {.n_triangles = 8, .kept = {true}}), Error);
}
TEST(Remesh, GivesEdgesNearTheTargetOnTheSurface) {
  const TriMesh torus = iso_torus();
  for (double edge : {0.7, 1.2, 2.0}) {
    const TriMesh mesh = remesh(torus, {.target_edge = edge});
    EXPECT_EQ(genus(mesh), 1);
    EXPECT_GT(share_of_edges(mesh, 0.7 * edge, 4.0 / 3.0 * edge), 0.97);
    EXPECT_LE(largest_distance(mesh, torus), 1e-9);
    EXPECT_NEAR(volume(mesh), volume(torus), 0.03 * volume(torus));
    const Adjacency around = vertex_triangles(mesh);
    Index regular = 0;
    for (Index v = 0; v < mesh.n_vertices(); ++v)
      regular += around[v].size() >= 5 && around[v].size() <= 7;
    EXPECT_GT(regular, 0.98 * mesh.n_vertices());
  }
}
TEST(Remesh, MoreIterationsEvenOutFurther) {
  const TriMesh torus = iso_torus();
  EXPECT_GT(share_of_edges(remesh(torus, {.target_edge = 1.0, .iterations = 8}), 0.8, 1.25),
            share_of_edges(remesh(torus, {.target_edge = 1.0, .iterations = 1}), 0.8, 1.25));
}
TEST(Remesh, KeepsThinShellsApart) {
  const TriMesh shell = test::lunate_shell(25.0, 0.8);
  const TriMesh mesh = remesh(shell, {.target_edge = 1.5});
  EXPECT_EQ(genus(mesh), 0);
  EXPECT_NEAR(volume(mesh), volume(shell),
              0.2 * volume(shell));  // its rim, 0.8 mm high, is rounded
}
TEST(Remesh, RejectsOpenSurfacesAndBadOptions) {
  EXPECT_THROW(remesh(test::plate(0.0), {}), Error);
  EXPECT_THROW(remesh(test::box(), {.target_edge = 0.0}), Error);
  EXPECT_THROW(remesh(test::box(), {.target_edge = 1e-6}), Error);
  EXPECT_THROW(remesh(test::box(), {.iterations = 0}), Error);
}
TEST(EdgeLengthFor, InvertsTheAreaOfEquilateralTriangles) {
  const TriMesh plate = test::plate(0.0);
  const double edge = edge_length_for(plate, 1000);
  EXPECT_NEAR(1000 * std::sqrt(3.0) / 4.0 * edge * edge, 400.0, 1e-9);
  EXPECT_THROW(edge_length_for(plate, 0), Error);
}

}  // namespace coxa
