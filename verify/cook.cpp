// Cook's membrane in plane strain and plane stress: the tapered panel (0,0) (48,44) (48,60) (0,44),
// unit thickness.
#include <coxa/core/error.h>
#include <coxa/dynamics/forces.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/fem/mean_dilatation.h>

#include <cmath>

#include "cases.h"
#include "shapes.h"

namespace coxa::verify {
namespace {

enum class Plane { stress, strain };

struct Membrane {
  Plane plane;
  double E, nu;
  double load;  // N, shear on the right edge
  Index cells;
};

struct Displacement {
  double middle, corner;  // vertical, right edge, mm
};

Displacement solve(const Membrane& membrane) {
  const Index n = membrane.cells;
  const TetMesh mesh = quadratic_mesh({n, n, 1, [&](Index i, Index j, Index k) {
                                         const double s = static_cast<double>(i) / n;
                                         const double t = static_cast<double>(j) / n;
                                         const double low = 44.0 * s, high = 44.0 + 16.0 * s;
                                         return Vec3(48.0 * s, low + t * (high - low), k);
                                       }});
  // neo-Hookean, its volumetric part by elements
  const fem::Lame lame = fem::lame_from(membrane.E, membrane.nu);
  const fem::ElasticForce elastic(mesh, fem::make_neo_hookean({0.0, lame.mu}));
  const fem::MeanDilatation volume(mesh, fem::volume_patches(mesh), lame.lambda);
  dynamics::Particles particles{fem::test::stacked(mesh.points), VecX::Zero(mesh.points.size()),
                                VecX::Ones(mesh.n_vertices())};
  dynamics::Constraints constraints;
  VecX load = VecX::Zero(mesh.points.size());
  for (Index i = 0; i < mesh.n_vertices(); ++i) {
    const bool held_z = membrane.plane == Plane::strain || mesh.points(i, 2) < 1e-9;
    if (mesh.points(i, 0) < 1e-9)
      constraints.add(i, Vec3(0, 0, held_z ? 0 : 1).asDiagonal(), Vec3::Zero());
    else if (held_z)
      constraints.add(i, Vec3(1, 1, 0).asDiagonal(), Vec3::Zero());
  }
  // uniform traction: middle nodes of the six-node faces carry a third of a face each
  const auto faces = faces_where(mesh, [](const Vec3& X) { return X[0] > 48.0 - 1e-9; });
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    for (int a = 3; a < 6; ++a)
      load[3 * faces(f, a) + 1] += membrane.load / static_cast<double>(faces.rows()) / 3.0;
  const dynamics::ConstantForce shear(load);
  const SolveReport report = dynamics::update_relax(
      particles, {&elastic, &volume, &shear}, constraints,
      {.tolerance = 1e-5 * std::abs(membrane.load), .linear_solver = dynamics::LinearSolver::ldlt});
  if (!report.converged) fail(ErrorCode::no_convergence, "Cook's membrane: ", report.reason);

  const auto vertical = [&](double y) {
    for (Index i = 0; i < mesh.n_vertices(); ++i)
      if ((mesh.points.row(i).transpose() - Vec3(48, y, 0)).norm() < 1e-9)
        return particles.x[3 * i + 1] - y;
    fail(ErrorCode::bad_mesh, "no node at height ", y);
  };
  return {vertical(52.0), vertical(60.0)};
}

}  // namespace

Rows cook() {
  Rows rows;
  // small strain: a load so small that the law is linear, the displacement scaled back
  constexpr double kSmall = 1e-4;
  const auto linear = [&](Plane plane, double nu, double known, double tolerance) {
    const auto ours = solve({plane, 1.0, nu, kSmall, 16});
    rows.push_back({join_text(plane == Plane::strain ? "plane strain" : "plane stress",
                              ", small strain, nu ", nu, ": middle, mm"),
                    known, ours.middle / kSmall, tolerance});
  };
  linear(Plane::stress, 1.0 / 3.0, 23.967, 0.01);
  linear(Plane::strain, 0.3, 21.945, 0.01);
  linear(Plane::strain, 0.42, 20.155, 0.01);
  linear(Plane::strain, 0.49, 18.74, 0.01);
  linear(Plane::strain, 0.499, 18.54, 0.01);
  linear(Plane::strain, 0.4999, 18.52, 0.01);
  for (const auto& [nu, middle, corner] :
       {std::tuple{0.42, 1.642, 1.702}, std::tuple{0.49, 1.53, 1.59}}) {
    const auto ours = solve({Plane::strain, 12.0, nu, 1.0, 16});
    rows.push_back({join_text("plane strain, neo-Hookean, nu ", nu, ": middle, mm"), middle,
                    ours.middle, 0.01});
    rows.push_back({join_text("plane strain, neo-Hookean, nu ", nu, ": corner, mm"), corner,
                    ours.corner, 0.01});
  }
  return rows;
}

}  // namespace coxa::verify
