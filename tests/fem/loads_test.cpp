#include <coxa/core/error.h>
#include <coxa/fem/loads.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "fem/shapes.h"

namespace coxa::fem {

TEST(BodyLoad, DoesTheWorkOfTheDensityInAQuadraticField) {
  const Vec3 density(1.0, -2.0, 0.5);
  for (const int nodes : {4, 10}) {
    TetMesh mesh = test::shaken(test::block(2, 1, 1, Vec3::Ones()), 0.1);
    if (nodes == 10) mesh = test::with_mid_nodes(mesh);
    const VecX load = body_load(mesh, density);
    // work in the linear field u = x: density . integral of x
    Vec3 moment = Vec3::Zero(), total = Vec3::Zero();
    for (Index e = 0; e < mesh.n_tets(); ++e) {
      Mat3 D;
      Vec3 centre = mesh.points.row(mesh.tets(e, 0)).transpose() / 4.0;
      for (int a = 1; a < 4; ++a) {
        D.col(a - 1) = mesh.points.row(mesh.tets(e, a)) - mesh.points.row(mesh.tets(e, 0));
        centre += mesh.points.row(mesh.tets(e, a)).transpose() / 4.0;
      }
      moment += D.determinant() / 6.0 * centre;
      total += D.determinant() / 6.0 * density;
    }
    EXPECT_NEAR(load.dot(test::stacked(mesh.points)), density.dot(moment), 1e-12);
    Vec3 sum = Vec3::Zero();
    for (Index i = 0; i < mesh.n_vertices(); ++i) sum += load.segment<3>(3 * i);
    EXPECT_LE((sum - total).norm(), 1e-13);
  }
}
TEST(BodyLoad, RejectsABrokenMesh) {
  TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  mesh.tets(0, 0) = 55;
  EXPECT_THROW(body_load(mesh, Vec3::UnitX()), Error);
}

}  // namespace coxa::fem
