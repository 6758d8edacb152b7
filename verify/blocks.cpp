// Homogeneous deformation: the curves of St-Venant and Kirchhoff, their limit point, and the patch
// test.
#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/dynamics/system.h>
#include <coxa/fem/results.h>

#include <algorithm>
#include <cmath>

#include "cases.h"
#include "shapes.h"

namespace coxa::verify {
namespace {

constexpr double kE = 12.0, kNu = 0.42;

/// Three faces of an irregular cube slide on the coordinate planes; the face x = 1 is brought to x
/// = stretch.
class Cube {
 public:
  enum class Sides { free, confined };
  Cube(Sides sides, Index cells) {
    const bool confined = sides == Sides::confined;
    mesh_ = fem::test::block(cells, cells, cells, Vec3::Constant(1.0 / cells));
    Rng rng(5);
    for (Index i = 0; i < mesh_.n_vertices(); ++i)
      for (int c = 0; c < 3; ++c) {
        double& value = mesh_.points(i, c);
        const double shake = 0.06 * rng.uniform(-1, 1);
        if (value > 0.1 && value < 0.9) value += shake;
      }
    elastic_ = std::make_unique<fem::ElasticForce>(
        mesh_, fem::make_st_venant_kirchhoff(fem::lame_from(kE, kNu)));
    particles_ = {fem::test::stacked(mesh_.points), VecX::Zero(mesh_.points.size()),
                  VecX::Ones(mesh_.n_vertices())};
    for (Index i = 0; i < mesh_.n_vertices(); ++i) {
      Vec3 free = Vec3::Ones();
      for (int c = 0; c < 3; ++c)
        if (mesh_.points(i, c) < 1e-9 || (mesh_.points(i, c) > 1 - 1e-9 && (c == 0 || confined)))
          free[c] = 0.0;
      if (free.sum() < 3.0) constraints_.add(i, free.asDiagonal(), Vec3::Zero());
    }
  }

  /// Force on the unit face x = 1 at this stretch, N.
  double pull(double stretch) {
    for (Index i = 0; i < mesh_.n_vertices(); ++i) particles_.x[3 * i] *= stretch / top_;
    top_ = stretch;

    const SolveReport report =
        dynamics::update_relax(particles_, {elastic_.get()}, constraints_,
                               {.tolerance = 1e-11, .linear_solver = dynamics::LinearSolver::ldlt});
    if (report.residual > 1e-10) fail(ErrorCode::no_convergence, "cube: ", report.reason);
    const VecX force = dynamics::total_force({elastic_.get()}, particles_.x, particles_.v);
    double sum = 0.0;
    for (Index i = 0; i < mesh_.n_vertices(); ++i)
      if (mesh_.points(i, 0) > 1 - 1e-9) sum -= force[3 * i];
    return sum;
  }
  double lateral() const {
    double side = 0.0;
    for (Index i = 0; i < mesh_.n_vertices(); ++i) side = std::max(side, particles_.x[3 * i + 1]);
    return side;
  }

 private:
  TetMesh mesh_;
  std::unique_ptr<fem::ElasticForce> elastic_;
  dynamics::Particles particles_;
  dynamics::Constraints constraints_;
  double top_ = 1.0;
};

}  // namespace

Rows st_venant_kirchhoff() {
  Rows rows;
  Cube free(Cube::Sides::free, 3), confined(Cube::Sides::confined, 3);
  const fem::Lame lame = fem::lame_from(kE, kNu);
  for (const double l : {1.3, 1.1, 0.9, 0.8, 0.7, 0.6}) {
    rows.push_back({join_text("free sides, stretch ", l, ": P, MPa"), 0.5 * kE * l * (l * l - 1.0),
                    free.pull(l), 1e-8, "P, MPa, sides free", l});
    rows.push_back({join_text("free sides, stretch ", l, ": lateral stretch"),
                    std::sqrt(1.0 - kNu * (l * l - 1.0)), free.lateral(), 1e-8});
    rows.push_back({join_text("confined, stretch ", l, ": P, MPa"),
                    0.5 * (lame.lambda + 2.0 * lame.mu) * l * (l * l - 1.0), confined.pull(l), 1e-8,
                    "P, MPa, sides confined", l});
  }
  // the largest push a block can bear, by golden section on the stretch; one cell, because beyond
  // the limit the strain of a finer block gathers in one layer
  const auto push = [](double stretch) { return Cube(Cube::Sides::free, 1).pull(stretch); };
  double low = 0.55, high = 0.61;
  const double share = 0.5 * (std::sqrt(5.0) - 1.0);
  for (int k = 0; k < 40; ++k) {
    const double a = high - share * (high - low), b = low + share * (high - low);
    (push(a) < push(b) ? high : low) = push(a) < push(b) ? b : a;
  }
  const double limit = 0.5 * (low + high);
  rows.push_back({"collapse: stretch", 1.0 / std::sqrt(3.0), limit, 1e-5});
  rows.push_back({"collapse: P / E", -1.0 / (3.0 * std::sqrt(3.0)), push(limit) / kE, 1e-8});
  return rows;
}

Rows patch() {
  TetMesh linear = fem::test::block(4, 4, 4, Vec3::Constant(0.25));
  Rng rng(9);
  const auto inside = [](const Vec3& X) {
    return X.minCoeff() > 1e-9 && X.maxCoeff() < 1.0 - 1e-9;
  };
  for (Index i = 0; i < linear.n_vertices(); ++i)
    if (inside(linear.points.row(i).transpose()))
      for (int c = 0; c < 3; ++c) linear.points(i, c) += 0.05 * rng.uniform(-1, 1);
  Mat3 F;
  F << 1.15, 0.1, -0.05, 0.02, 0.85, 0.15, 0.1, -0.08, 1.05;
  Rows rows;
  for (const int nodes : {4, 10}) {
    const TetMesh mesh = nodes == 4 ? linear : fem::test::with_mid_nodes(linear);
    const fem::ElasticForce elastic(mesh, fem::make_neo_hookean(fem::lame_from(kE, kNu)));
    dynamics::Particles particles{fem::test::stacked(mesh.points), VecX::Zero(mesh.points.size()),
                                  VecX::Ones(mesh.n_vertices())};
    dynamics::Constraints constraints;
    for (Index i = 0; i < mesh.n_vertices(); ++i) {
      const Vec3 X = mesh.points.row(i);
      particles.x.segment<3>(3 * i) = F * X;
      if (inside(X))  // starts away from the answer
        particles.x.segment<3>(3 * i) += 0.02 * rng.normal3().cwiseMax(-1.0).cwiseMin(1.0);
      else
        constraints.hold(i);
    }
    dynamics::update_relax(particles, {&elastic}, constraints,
                           {.tolerance = 1e-11, .linear_solver = dynamics::LinearSolver::ldlt});
    double worst = 0.0;
    for (const Mat3& found : fem::compute_fields(elastic, particles.x).deformation_gradient)
      worst = std::max(worst, (found - F).norm());
    rows.push_back({join_text(nodes, "-node tets: largest error of F"), 0.0, worst, 1e-12});
  }
  return rows;
}

}  // namespace coxa::verify
