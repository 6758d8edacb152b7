// A rigid, frictionless sphere pressed into elastic bodies, each as a narrow sector about the axis.
#include <coxa/core/error.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/fem/mean_dilatation.h>
#include <coxa/fem/sphere_contact.h>

#include <algorithm>
#include <cmath>

#include "cases.h"
#include "shapes.h"

namespace coxa::verify {
namespace {

struct Indentation {
  double E, nu, radius, depth;
  double peak;               // MPa, about; sets the penalty
  std::vector<double> r, z;  // grid lines, mm; the top surface is z.back()
  int nodes = 10;            // of an element: 4 or 10
};

struct Answer {
  double force, peak, contact_radius;  // N, MPa, mm
};

constexpr double kSectorAngle = radians(4.0);

/// Bonded at the bottom; the sides of the sector slide in their planes, the axis along z.
dynamics::Constraints sector_constraints(const Sector& sector) {
  const Points& X = sector.mesh.points;
  dynamics::Constraints constraints;
  for (Index i = 0; i < sector.mesh.n_vertices(); ++i) {
    const double radius = X.row(i).head<2>().norm();
    const double phi = std::atan2(X(i, 1), X(i, 0));
    if (X(i, 2) < 1e-9) {
      constraints.hold(i);
    } else if (radius < 1e-9) {
      constraints.add(i, Vec3(0, 0, 1).asDiagonal(), Vec3::Zero());
    } else if (std::abs(std::abs(phi) - 0.5 * sector.angle) < 1e-6) {
      const Vec3 across(-std::sin(phi), std::cos(phi), 0.0);
      constraints.add(i, Mat3::Identity() - across * across.transpose(), Vec3::Zero());
    }
  }
  return constraints;
}

Answer press(const Indentation& in) {
  Sector sector = make_sector(in.r, in.z, kSectorAngle);
  const double top = in.z.back();
  fem::ContactFaces faces =
      faces_where(sector.mesh, [&](const Vec3& X) { return X[2] > top - 1e-9; });
  if (in.nodes == 4) {
    sector.mesh = corners_only(sector.mesh);
    faces = faces.leftCols(3).eval();
  }
  const TetMesh& mesh = sector.mesh;
  const fem::Lame lame = fem::lame_from(in.E, in.nu);
  const fem::ElasticForce elastic(mesh, fem::make_neo_hookean({0.0, lame.mu}));
  const fem::MeanDilatation volume(mesh, fem::volume_patches(mesh), lame.lambda);
  dynamics::Particles particles{fem::test::stacked(mesh.points), VecX::Zero(mesh.points.size()),
                                VecX::Ones(mesh.n_vertices())};
  // so stiff that the sphere enters the surface by no more than a thousandth of the depth
  const double penalty = 1000.0 * in.peak / in.depth;
  fem::SphereContact contact(faces, particles.x, {Vec3(0, 0, top + in.radius), in.radius}, penalty);
  const auto constraints = sector_constraints(sector);
  constexpr int kSteps = 4;
  for (int step = 1; step <= kSteps; ++step) {
    contact.set_sphere({Vec3(0, 0, top + in.radius - in.depth * step / kSteps), in.radius});
    const SolveReport report =
        dynamics::update_relax(particles, {&elastic, &volume, &contact}, constraints,
                               {.tolerance = 1e-5 * in.peak * in.radius * in.depth * sector.angle,
                                .max_iterations = 200,
                                .linear_solver = dynamics::LinearSolver::ldlt});
    if (!report.converged) fail(ErrorCode::no_convergence, "sphere on a layer: ", report.reason);
  }
  Answer answer{-contact.resultant(particles.x)[2] * sector.multiplicity(), 0.0, 0.0};
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    for (Eigen::Index a = 0; a < faces.cols(); ++a) {
      const Vec3 x = particles.position(faces(f, a));
      if (contact.pressure_at(x) <= 0.0) continue;
      answer.contact_radius = std::max(answer.contact_radius, x.head<2>().norm());
      if (x.head<2>().norm() < 1e-9) answer.peak = contact.pressure_at(x);
    }
  return answer;
}

/// A layer 1 mm thick, n cells out to `end`, five layers of cells; the sphere enters by 0.005 mm.
Indentation layer(double E, double nu, double radius, double peak, double end, int n) {
  return {E, nu, radius, 0.005, peak, graded(end, n, 1.0), graded(1.0, 5, 1.0)};
}

}  // namespace

Rows hertz() {
  const double E = 12.0, nu = 0.42, R = 25.0, d = 0.1, reduced = E / (1.0 - nu * nu);
  // the half space ends 60 contact radii away; cells grow from the contact outwards and downwards
  std::vector<double> z = graded(80.0, 20, 1.28);
  std::reverse(z.begin(), z.end());
  for (double& value : z) value = 80.0 - value;
  const Answer ours = press({E, nu, R, d, 0.6, graded(80.0, 24, 1.22), z});
  const double a = std::sqrt(R * d);
  return {{"force, N", 4.0 / 3.0 * reduced * a * d, ours.force, 0.03},
          {"peak pressure, MPa", 2.0 * reduced * a / (kPi * R), ours.peak, 0.03},
          {"contact radius, mm", a, ours.contact_radius, 0.05}};
}

Rows compressible_layer() {
  const Answer thin = press(layer(12.0, 0.42, 20000.0, 0.15, 24.0, 60));
  const Answer thick =
      press({12.0, 0.42, 25.0, 0.1, 1.0, graded(16.0, 48, 1.04), graded(2.0, 8, 1.0)});
  return {{"R 20000, h 1, d 0.005: force, N", 47.28, thin.force, 0.05},
          {"R 20000, h 1, d 0.005: peak, MPa", 0.1500, thin.peak, 0.05},
          {"R 25, h 2, d 0.1: force, N", 8.64, thick.force, 0.05},
          {"R 25, h 2, d 0.1: peak, MPa", 1.055, thick.peak, 0.05}};
}

Rows incompressible_layer() {
  const Answer soft = press(layer(12.0, 0.495, 5000.0, 0.62, 20.0, 60));
  const Answer hard = press(layer(12.0, 0.4999, 20000.0, 3.0, 40.0, 80));
  Indentation linear = layer(12.0, 0.495, 5000.0, 0.62, 20.0, 120);
  linear.nodes = 4;
  const Answer patches = press(linear);
  return {{"nu 0.495, R 5000, four-node tets in patches: force, N", 59.05, patches.force, 0.05},
          {"nu 0.495, R 5000: force, N", 59.05, soft.force, 0.05},
          {"nu 0.495, R 5000: peak, MPa", 0.619, soft.peak, 0.05},
          {"nu 0.495, R 5000: contact radius, mm", 8.34, soft.contact_radius, 0.05},
          {"nu 0.4999, R 20000: force, N", 1260.6, hard.force, 0.05},
          {"nu 0.4999, R 20000: peak, MPa", 3.04, hard.peak, 0.05}};
}

}  // namespace coxa::verify
