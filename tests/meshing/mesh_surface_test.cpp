#include <coxa/meshing/mesh_surface.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <Eigen/Geometry>

#include <vector>

namespace coxa::meshing {

const TriMesh shell = test::lunate_shell(25.0, 1.6);

double tet_volume(const TetMesh& mesh, Index t) {
  const Vec3 a = mesh.points.row(mesh.tets(t, 0)), b = mesh.points.row(mesh.tets(t, 1)),
             c = mesh.points.row(mesh.tets(t, 2)), d = mesh.points.row(mesh.tets(t, 3));
  return (b - a).cross(c - a).dot(d - a) / 6.0;
}

void expect_valid(const TetMesh& mesh, const TriMesh& surface) {
  double total = 0.0;
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    ASSERT_GT(tet_volume(mesh, t), 0.0) << "element " << t;
    total += tet_volume(mesh, t);
  }
  EXPECT_NEAR(total / volume(surface), 1.0, 0.03);
  EXPECT_EQ(manifold_fault({mesh.points, mesh.facets}), "");
  ASSERT_EQ(mesh.facet_tags.size(), static_cast<std::size_t>(mesh.facets.rows()));
}

TEST(MeshSurface, FillsAWalledShellWithGoodElements) {
  const MeshingResult made = mesh_surface(shell);
  expect_valid(made.mesh, shell);
  EXPECT_EQ(made.report.method, Method::medial);
  EXPECT_GT(made.report.quality.aspect_mean, 0.75);
  EXPECT_LE(made.mesh.n_tets(), 20000);
}

TEST(MeshSurface, IsTheSameForOneAndEightThreads) {
  const auto run = [&] { return mesh_surface(shell, {.max_tets = 4000}); };
  const MeshingResult one = with_threads(1, run), eight = with_threads(8, run);
  EXPECT_EQ(one.mesh.points, eight.mesh.points);
  EXPECT_EQ(one.mesh.tets, eight.mesh.tets);
}

/// Edges from each node to the nearest node of a facet with the tag.
std::vector<int> steps_from(const TetMesh& mesh, FacetTag tag) {
  std::vector<int> steps(static_cast<std::size_t>(mesh.points.rows()), 1000);
  for (Index f = 0; f < mesh.facets.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      if (mesh.facet_tags[static_cast<std::size_t>(f)] == tag)
        steps[static_cast<std::size_t>(mesh.facets(f, k))] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (Index i = 0; i < mesh.tets.size(); ++i) {
      const Index t = i / 4;
      for (int k = 0; k < 4; ++k) {
        int& mine = steps[static_cast<std::size_t>(mesh.tets.data()[i])];
        const int theirs = 1 + steps[static_cast<std::size_t>(mesh.tets(t, k))];
        if (theirs < mine) {
          mine = theirs;
          changed = true;
        }
      }
    }
  }
  return steps;
}

TEST(MeshSurface, HasExactlyTheLayersAskedForAwayFromTheRim) {
  for (const int layers : {1, 2, 3}) {
    const TetMesh mesh = mesh_surface(shell, {.layers = layers, .max_tets = 4000 * layers}).mesh;
    const std::vector<int> from_bone = steps_from(mesh, FacetTag::bone_side),
                           from_other = steps_from(mesh, FacetTag::articular_side),
                           from_rim = steps_from(mesh, FacetTag::rim);
    Index checked = 0;
    for (std::size_t v = 0; v < from_bone.size(); ++v) {
      if (from_rim[v] <= layers || from_bone[v] == 1000) continue;
      // every node lies on one level: as many layers below it as are missing above it
      EXPECT_EQ(from_bone[v] + from_other[v], layers)
          << "node " << v << ", " << layers << " layers";
      ++checked;
    }
    EXPECT_GT(checked, 50);
  }
}

TEST(MeshSurface, RefusesOptionsOutOfRangeAndOpenSurfaces) {
  EXPECT_THROW(mesh_surface(shell, {.layers = 0}), Error);
  EXPECT_THROW(mesh_surface(shell, {.layers = 9}), Error);
  EXPECT_THROW(mesh_surface(shell, {.max_tets = 10}), Error);
  EXPECT_THROW(mesh_surface(shell, {.cell_per_thickness = 0.0}), Error);
  EXPECT_THROW(mesh_surface(shell, {.rim_rounding = 0.3}), Error);
  EXPECT_THROW(mesh_surface(shell, {.improvement_rounds = -1}), Error);
  EXPECT_THROW(mesh_surface(test::plate(0.0)), Error);
}

}  // namespace coxa::meshing
