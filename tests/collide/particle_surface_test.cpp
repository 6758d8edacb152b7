#include <coxa/collide/particle_surface.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include "collide/shapes.h"

namespace coxa::collide {

TEST(ParticleSurface, KeepsTheParticlesThatTrianglesName) {
  Triangles triangles(2, 3);
  triangles << 7, 3, 9, 9, 3, 12;
  const ParticleSurface surface = make_particle_surface(triangles);
  EXPECT_EQ(surface.particle, (std::vector<Index>{3, 7, 9, 12}));
  VecX x = VecX::LinSpaced(39, 0.0, 38.0);
  const Points points = surface_points(surface, x);
  EXPECT_EQ(points(surface.triangles(0, 0), 0), 21.0);
  EXPECT_EQ(points(surface.triangles(1, 2), 2), 38.0);
}
TEST(ParticleSurface, OfASimplexMeshIsItsFan) {
  const SimplexMesh mesh = make_simplex_mesh(test::icosphere(1, 10.0, Vec3(1, 2, 3)));
  const ParticleSurface surface = make_particle_surface(mesh, 5);
  const TriMesh fan = fan_surface(mesh);
  VecX x = VecX::Zero(15 + 3 * mesh.n_vertices());
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    x.segment<3>(15 + 3 * v) = mesh.points.row(v).transpose();
  EXPECT_LE((surface_points(surface, x) - fan.points).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(surface.triangles, fan.triangles);
}
TEST(ParticleSurface, RejectsNoTriangleAndNegativeParticles) {
  EXPECT_THROW(make_particle_surface(Triangles()), Error);
  EXPECT_THROW(make_particle_surface(Triangles::Constant(1, 3, -1)), Error);
}
TEST(BoundaryEdges, AreTheOuterEdgesOfAPlateAndNoneOfASphere) {
  EXPECT_EQ((edge_neighbours(test::plate(0.0, 1.0, 3).triangles).array() < 0).count(), 12);
  EXPECT_EQ((edge_neighbours(test::icosphere(1, 1.0, Vec3::Zero()).triangles).array() < 0).count(),
            0);
}

}  // namespace coxa::collide
