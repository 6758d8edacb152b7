// A cylinder twisted between its ends, nearly incompressible neo-Hookean: torque and Poynting
// force.
#include <coxa/core/error.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/dynamics/system.h>
#include <coxa/fem/mean_dilatation.h>

#include <cmath>

#include "cases.h"
#include "shapes.h"

namespace coxa::verify {
namespace {

constexpr double kRadius = 1.0, kLength = 0.5, kShear = 1.0, kNu = 0.4999;

/// Ten-node cylinder about z; the nodes in the middle of the outer edges lie on it.
TetMesh cylinder() {
  constexpr Index kRings = 5, kSectors = 16, kSlices = 2;
  TetMesh mesh =
      quadratic_mesh({kRings, kSectors, kSlices, [](Index i, Index j, Index k) {
                        const double r = kRadius * i / kRings;
                        const double phi = 2.0 * kPi * (j % kSectors) / kSectors;
                        return Vec3(r * std::cos(phi), r * std::sin(phi), kLength * k / kSlices);
                      }});
  const double chord = kRadius * std::cos(kPi / kSectors);
  for (Index i = 0; i < mesh.n_vertices(); ++i) {
    const double r = mesh.points.row(i).head<2>().norm();
    if (std::abs(r - chord) < 1e-9) mesh.points.row(i).head<2>() *= kRadius / r;
  }
  return mesh;
}

}  // namespace

Rows torsion() {
  const TetMesh mesh = cylinder();
  // incompressible: lambda / mu = 2 nu / (1 - 2 nu)
  const double lambda = kShear * 2.0 * kNu / (1.0 - 2.0 * kNu);
  const fem::ElasticForce elastic(mesh, fem::make_neo_hookean({0.0, kShear}));
  const fem::MeanDilatation volume(mesh, fem::volume_patches(mesh), lambda);
  dynamics::Constraints constraints;
  for (Index i = 0; i < mesh.n_vertices(); ++i)
    if (mesh.points(i, 2) < 1e-9 || mesh.points(i, 2) > kLength - 1e-9) constraints.hold(i);
  dynamics::Particles particles{fem::test::stacked(mesh.points), VecX::Zero(mesh.points.size()),
                                VecX::Ones(mesh.n_vertices())};
  Rows rows;
  double before = 0.0;
  for (const double twist : {0.3, 0.6, 1.0}) {  // rad/mm
    for (Index i = 0; i < mesh.n_vertices(); ++i) {
      const double turn = (twist - before) * mesh.points(i, 2);
      const double c = std::cos(turn), s = std::sin(turn);
      const double x = particles.x[3 * i], y = particles.x[3 * i + 1];
      particles.x[3 * i] = c * x - s * y;
      particles.x[3 * i + 1] = s * x + c * y;
    }
    before = twist;
    const SolveReport report = dynamics::update_relax(
        particles, {&elastic, &volume}, constraints,
        {.tolerance = 1e-8, .max_iterations = 100, .linear_solver = dynamics::LinearSolver::ldlt});
    if (!report.converged) fail(ErrorCode::no_convergence, "twisted cylinder: ", report.reason);
    const VecX force = dynamics::total_force({&elastic, &volume}, particles.x, particles.v);
    double torque = 0.0, axial = 0.0;
    for (Index i = 0; i < mesh.n_vertices(); ++i) {
      if (mesh.points(i, 2) < kLength - 1e-9) continue;
      torque -= particles.x[3 * i] * force[3 * i + 1] - particles.x[3 * i + 1] * force[3 * i];
      axial -= force[3 * i + 2];
    }
    const double a4 = std::pow(kRadius, 4);
    rows.push_back({join_text("twist ", twist, " rad/mm: torque, N mm"),
                    0.5 * kPi * kShear * twist * a4, torque, 0.01, "torque, N mm", twist});
    rows.push_back({join_text("twist ", twist, " rad/mm: axial force, N"),
                    -0.25 * kPi * kShear * twist * twist * a4, axial, 0.01, "axial force, N",
                    twist});
  }
  return rows;
}

}  // namespace coxa::verify
