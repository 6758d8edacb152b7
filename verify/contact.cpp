// Contact between surfaces: the patch test over meshes that do not match, and a ball in its cup.
#include <coxa/collide/contact_friction.h>
#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/dynamics/forces.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/fem/elastic_force.h>
#include <coxa/joint/simulate.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "cases.h"
#include "joint/layers.h"
#include "joint/movements.h"
#include "shapes.h"

namespace coxa::verify {
namespace {

/// Two blocks of 10 × 10 × 5 mm, one on the other, of different and irregular meshes.
struct StackedBlocks {
  static constexpr double kSide = 10.0, kHeight = 5.0;
  TetMesh mesh;  // of both
  Index n_lower = 0;

  StackedBlocks(Index lower_cells, Index upper_cells) {
    const TetMesh lower = block(lower_cells, 0.0, 3), upper = block(upper_cells, kHeight, 4);
    n_lower = lower.n_vertices();
    mesh.points.resize(n_lower + upper.n_vertices(), 3);
    mesh.points << lower.points, upper.points;
    mesh.tets.resize(lower.n_tets() + upper.n_tets(), 4);
    mesh.tets << lower.tets, (upper.tets.array() + n_lower).matrix();
  }

  /// Faces in the plane z = height of the lower (first = 0) or the upper block.
  Triangles faces_at(double height, bool of_upper) const {
    const TetMesh with_middles = fem::test::with_mid_nodes(mesh);
    const auto faces =
        faces_where(with_middles, [&](const Vec3& X) { return std::abs(X[2] - height) < 1e-9; });
    std::vector<Eigen::RowVector3i> kept;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
      if ((faces(f, 0) >= n_lower) == of_upper) kept.push_back(outward(faces.row(f).head<3>()));
    Triangles triangles(static_cast<Eigen::Index>(kept.size()), 3);
    for (std::size_t f = 0; f < kept.size(); ++f)
      triangles.row(static_cast<Eigen::Index>(f)) = kept[f];
    return triangles;
  }

 private:
  static TetMesh block(Index cells, double bottom, std::uint64_t seed) {
    TetMesh mesh = fem::test::block(cells, cells, 3, {kSide / cells, kSide / cells, kHeight / 3});
    Rng rng(seed);
    const Vec3 size(kSide, kSide, kHeight);
    for (Index i = 0; i < mesh.n_vertices(); ++i) {
      for (int c = 0; c < 3; ++c) {
        const double shake = 0.15 * (c == 2 ? kHeight / 3 : kSide / cells) * rng.uniform(-1, 1);
        double& value = mesh.points(i, c);
        if (value > 1e-9 && value < size[c] - 1e-9) value += shake;
      }
      mesh.points(i, 2) += bottom;
    }
    return mesh;
  }
  /// A face of the lower block's top looks up, of the upper block's bottom down, of its top up.
  Eigen::RowVector3i outward(Eigen::RowVector3i face) const {
    const auto corner = [&](int k) { return Vec3(mesh.points.row(face[k])); };
    const double up = (corner(1) - corner(0)).cross(corner(2) - corner(0))[2];
    const bool looks_down = face[0] >= n_lower && corner(0)[2] < kHeight + 1e-6;
    if ((up < 0.0) != looks_down) std::swap(face[1], face[2]);
    return face;
  }
};

/// Largest differences from the uniform state, relative to its pressure.
struct PatchError {
  double pressure = 0.0, stress = 0.0;
};

PatchError press_together(Index lower_cells, Index upper_cells,
                          const collide::ContactOptions& options) {
  constexpr double kPressure = 0.05;  // MPa
  const StackedBlocks blocks(lower_cells, upper_cells);
  const fem::ElasticForce elastic(blocks.mesh,
                                  fem::make_st_venant_kirchhoff(fem::lame_from(12.0, 0.3)));
  collide::SurfaceContact contact(
      collide::make_particle_surface(blocks.faces_at(StackedBlocks::kHeight, true)),
      collide::make_particle_surface(blocks.faces_at(StackedBlocks::kHeight, false)), options);
  const TetMesh& mesh = blocks.mesh;
  VecX load = VecX::Zero(mesh.points.size());
  const Triangles top = blocks.faces_at(2.0 * StackedBlocks::kHeight, true);
  for (Index f = 0; f < top.rows(); ++f) {
    const auto corner = [&](int k) { return Vec3(mesh.points.row(top(f, k))); };
    const double area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (int k = 0; k < 3; ++k) load[3 * top(f, k) + 2] -= kPressure * area / 3.0;
  }
  const dynamics::ConstantForce push(load);
  dynamics::Constraints constraints;  // three planes of symmetry; the other sides are free
  for (Index i = 0; i < mesh.n_vertices(); ++i) {
    const Vec3 free = (mesh.points.row(i).transpose().array() > 1e-9).cast<double>();
    if (free.sum() < 3.0) constraints.add(i, free.asDiagonal(), Vec3::Zero());
  }
  dynamics::Particles particles{fem::test::stacked(mesh.points), VecX::Zero(mesh.points.size()),
                                VecX::Ones(mesh.n_vertices())};
  // a first touch, so that there is something to press against
  for (Index i = blocks.n_lower; i < mesh.n_vertices(); ++i) particles.x[3 * i + 2] -= 1e-5;
  for (int round = 0; round < 6; ++round) {
    contact.update_pairs(particles.x);
    const SolveReport report =
        dynamics::update_relax(particles, {&elastic, &contact, &push}, constraints,
                               {.tolerance = 1e-9, .linear_solver = dynamics::LinearSolver::ldlt});
    if (!report.converged) fail(ErrorCode::no_convergence, "stacked blocks: ", report.reason);
  }
  // the blocks grow sideways: the same force on a larger area
  double area = 0.0;
  for (const collide::ContactConstraint& constraint : contact.constraints())
    area += constraint.area;
  const double known = kPressure * StackedBlocks::kSide * StackedBlocks::kSide / area;
  PatchError error;
  for (const collide::ContactConstraint& constraint : contact.constraints())
    error.pressure =
        std::max(error.pressure, std::abs(contact.pressure(constraint, particles.x) / known - 1.0));
  for (Index e = 0; e < mesh.n_tets(); ++e)
    error.stress = std::max(error.stress,
                            std::abs(elastic.cauchy_stress(particles.x, e)(2, 2) / -known - 1.0));
  return error;
}

}  // namespace

Rows contact_patch() {
  Rows rows;
  for (const auto& [slave, name] : {std::pair{7, "finer"}, std::pair{4, "coarser"}}) {
    const PatchError error = press_together(5, slave,
                                            {.stiffness = 100.0,
                                             .quadrature = collide::ContactQuadrature::cut,
                                             .rule = collide::ContactRule::nodal});
    rows.push_back({join_text("cut, slave ", name, ": largest error of a nodal pressure"), 0.0,
                    error.pressure, 1e-6});
    rows.push_back({join_text("cut, slave ", name, ": largest error of an element's stress"), 0.0,
                    error.stress, 1e-6});
  }
  const PatchError fast = press_together(5, 7,
                                         {.stiffness = 100.0,
                                          .quadrature = collide::ContactQuadrature::six_points,
                                          .rule = collide::ContactRule::nodal});
  rows.push_back(
      {"six points, slave finer: largest error of a nodal pressure", 0.0, fast.pressure, 0.03});
  rows.push_back(
      {"six points, slave finer: largest error of an element's stress", 0.0, fast.stress, 0.03});
  return rows;
}

Rows ball_in_cup() {
  constexpr double kForce = 2000.0, kRadius = 25.0, kBands = 6;
  const joint::JointModel model = test::make_ball_in_cup();
  motion::HipMotion rest;
  rest.time.push_back(0.0);
  rest.angles.push_back({});
  rest.X_PF.push_back({motion::rotation_from_angles({}, model.side), Vec3::Zero()});
  const joint::JointResult result = joint::simulate(
      model, rest, joint::passive_examination(model, kForce), {.centre_shift = std::nullopt});
  const joint::FrameResult& frame = result.frames.front();
  if (frame.status != joint::FrameStatus::converged)
    fail(ErrorCode::no_convergence, "ball in a cup: ", frame.reason);
  // Winkler bed over a cap of 60 degrees
  const double p0 = 3.0 * kForce / (2.0 * kPi * kRadius * kRadius * (1.0 - 0.125));
  // the bed does not know that the layers' free edge gives way: on finer meshes the mean pressure
  // settles 1.9 % below it, with either way of resisting volume change (docs/verification.md)
  Rows rows{{"peak pressure (99th percentile), MPa", p0, frame.contact.peak_pressure_p99, 0.01},
            {"mean pressure, MPa", 0.75 * p0, frame.contact.mean_pressure, 0.02},
            {"contact area, mm2", kPi * kRadius * kRadius, frame.contact.contact_area, 0.01},
            {"|contact - applied| / applied", 0.0, frame.balance.force_error, 1e-4}};
  const Points& X = model.acetabular_cartilage.points;
  for (int band = 0; band < kBands; ++band) {
    double sum = 0.0, angle = 0.0;
    int count = 0;
    for (Index i = 0; i < X.rows(); ++i) {
      const double polar = degrees(std::acos(std::min(1.0, X(i, 2) / X.row(i).norm())));
      if (frame.acetabular_pressure[i] <= 0.0 || polar < 10.0 * band || polar >= 10.0 * (band + 1))
        continue;
      sum += frame.acetabular_pressure[i];
      angle += polar;
      ++count;
    }
    rows.push_back(
        {join_text("mean nodal pressure, ", 10 * band, " to ", 10 * (band + 1), " degrees"),
         p0 * std::cos(radians(angle / count)), sum / count, 0.05, "pressure, MPa", angle / count});
  }
  return rows;
}

namespace {

/// Velocity down the slope, mm/s, of a block of 10 × 10 × 2 mm that was let go `time` s before on a
/// rigid slope.
double slide(double slope, double coefficient, double time) {
  constexpr double kGravity = 9810.0, kDensity = 1.1e-9, kStiffness = 1.0;  // mm/s², t/mm³, MPa/mm
  constexpr int kSteps = 200;
  const TetMesh mesh = fem::test::block(4, 4, 1, Vec3(2.5, 2.5, 2.0));
  const auto faces =
      faces_where(fem::test::with_mid_nodes(mesh), [](const Vec3& X) { return X[2] < 1e-9; });
  Triangles bottom = faces.leftCols(3);
  for (Index f = 0; f < bottom.rows(); ++f) {
    const auto corner = [&](int k) { return Vec3(mesh.points.row(bottom(f, k))); };
    if ((corner(1) - corner(0)).cross(corner(2) - corner(0))[2] > 0.0)
      std::swap(bottom(f, 1), bottom(f, 2));
  }
  TriMesh ground;
  ground.points.resize(4, 3);
  ground.points << -50, -50, 0, 100, -50, 0, 100, 100, 0, -50, 100, 0;
  ground.triangles.resize(2, 3);
  ground.triangles << 0, 1, 2, 0, 2, 3;

  const fem::ElasticForce elastic(mesh, fem::make_corotational(fem::lame_from(10.0, 0.3)));
  collide::SurfaceContact contact(collide::make_particle_surface(bottom), ground,
                                  {.stiffness = kStiffness, .rule = collide::ContactRule::nodal});
  collide::ContactFriction friction(coefficient, kStiffness);
  dynamics::Particles particles{fem::test::stacked(mesh.points), VecX::Zero(mesh.points.size()),
                                fem::lumped_masses(mesh, kDensity, mesh.n_vertices())};
  VecX load(mesh.points.size());
  for (Index i = 0; i < mesh.n_vertices(); ++i)
    load.segment<3>(3 * i) =
        particles.mass[i] * kGravity * Vec3(std::sin(slope), 0.0, -std::cos(slope));
  const dynamics::ConstantForce weight(load);
  // so deep that the ground carries the block from the start
  const double depth = particles.mass.sum() * kGravity * std::cos(slope) / (100.0 * kStiffness);
  for (Index i = 0; i < mesh.n_vertices(); ++i) particles.x[3 * i + 2] -= depth;

  dynamics::Stepper stepper(mesh.n_vertices(), {&elastic, &weight, &contact, &friction});
  for (int step = 0; step < kSteps; ++step) {
    contact.update_pairs(particles.x);
    friction.begin_step(particles.x);
    friction.update(contact, particles.x);
    stepper.update_pattern();
    stepper.update_step(particles, {},
                        {.integrator = dynamics::Integrator::backward_euler,
                         .time_step = time / kSteps,
                         .newton_iterations = 8,
                         .linear = {.tolerance = 1e-10}});
    friction.end_step(particles.x);
  }
  double momentum = 0.0;
  for (Index i = 0; i < mesh.n_vertices(); ++i) momentum += particles.mass[i] * particles.v[3 * i];
  return momentum / particles.mass.sum();
}

/// Moment of friction on a cup in which a ball turns by `turn` about the axis, pressed into it.
double turning_moment(double force, double friction, double turn) {
  joint::JointModel model = test::make_ball_in_cup();
  model.friction = friction;
  const auto motion = test::movement_to({0.0, 0.0, turn}, 2);
  const joint::JointResult result = joint::simulate(
      model, motion, joint::passive_examination(model, force), {.centre_shift = std::nullopt});
  const joint::FrameResult& frame = result.frames.back();
  if (frame.status != joint::FrameStatus::converged)
    fail(ErrorCode::no_convergence, "turning ball: ", frame.reason);
  return frame.balance.friction_moment.norm();
}

}  // namespace

Rows slope() {
  constexpr double kTime = 0.1, kGravity = 9810.0;
  Rows rows;
  for (const double degrees : {25.0, 30.0, 40.0, 55.0}) {
    const double angle = radians(degrees);
    rows.push_back({join_text("slope ", degrees, " degrees, coefficient 0.3: mm/s after 0.1 s"),
                    kGravity * kTime * (std::sin(angle) - 0.3 * std::cos(angle)),
                    slide(angle, 0.3, kTime), 0.01, "velocity after 0.1 s, mm/s", degrees});
  }
  // below atan(0.3) = 16.7 degrees it stays where it is
  rows.push_back({"slope 15 degrees, coefficient 0.3: over that without friction", 0.0,
                  slide(radians(15.0), 0.3, kTime) / (kGravity * kTime * std::sin(radians(15.0))),
                  1e-3});
  // pressure as the cosine of the angle on a cap of 60 degrees and radius 25 mm: mu F R sin^3 /
  // (1 - cos^3)
  constexpr double kForce = 500.0, kFriction = 0.05;
  const double sine = std::sin(radians(60.0));
  rows.push_back({"ball turning in a cup, coefficient 0.05: moment, N mm",
                  kFriction * kForce * 25.0 * sine * sine * sine / (1.0 - 0.125),
                  turning_moment(kForce, kFriction, radians(6.0)), 0.01});
  return rows;
}

}  // namespace coxa::verify
