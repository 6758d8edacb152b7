#include <coxa/segment/seat.h>

#include <gtest/gtest.h>

#include "toy.h"

namespace coxa::segment {
namespace {

/// Closed sheet, 2 mm thick, 0.1 mm above the cap of a sphere of radius 20.
TriMesh cap() {
  TriMesh mesh = test::icosphere(4, 1.0);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 u = mesh.points.row(v).transpose();
    // the lower half of the unit sphere becomes the seat, the upper half the free side
    const Vec3 direction = Vec3(u.x(), u.y(), 1.2).normalized();
    const double r = u.z() < 0.0 ? 20.1 : 20.1 + 2.0 * u.z();
    mesh.points.row(v) = (r * direction).transpose();
  }
  return mesh;
}

shape::StructureModel model_of(const TriMesh& mesh, const std::string& name) {
  shape::StructureModel model;
  model.name = name;
  model.hierarchy.levels.push_back(make_simplex_mesh(mesh));
  return model;
}

}  // namespace

TEST(FindHosts, ALayerLiesOnTheLargeBodyAndTheBodyOnNothing) {
  const auto body = model_of(test::icosphere(4, 20.0), "ball"), layer = model_of(cap(), "cap");
  const auto hosts = find_hosts({&layer, &body});
  ASSERT_TRUE(hosts[0].has_value());
  EXPECT_EQ(*hosts[0], 1u);
  EXPECT_FALSE(hosts[1].has_value());
}

TEST(SeatedVertices, AreTheHalfThatFacesTheHost) {
  const auto layer = model_of(cap(), "cap");
  const VecX seated = seated_vertices(layer, test::icosphere(4, 20.0));
  EXPECT_NEAR(seated.mean(), 0.5, 0.06);
  const Points& p = layer.hierarchy.levels.back().points;
  for (Index v = 0; v < p.rows(); ++v) {
    if (p.row(v).norm() > 20.6) {
      EXPECT_EQ(seated[v], 0.0);
    }
  }
}

TEST(CarriedPoints, KeepTheirHeightOverASurfaceThatGrowsAndTurns) {
  const TriMesh before = test::icosphere(4, 20.0), bigger = test::icosphere(4, 25.0);
  const RigidTransform X = test::some_pose();
  const Points points = cap().points;
  const Points now = carried_points(points, before, test::moved(bigger, X));
  for (Index v = 0; v < points.rows(); ++v) {
    const double height = points.row(v).norm() - 20.0;
    EXPECT_NEAR((X.inverse() * Vec3(now.row(v).transpose())).norm(), 25.0 + height, 0.15);
  }
}

TEST(CarriedPoints, AreUnchangedByNoChange) {
  const TriMesh ball = test::icosphere(3, 20.0);
  EXPECT_LE((carried_points(cap().points, ball, ball) - cap().points).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace coxa::segment
