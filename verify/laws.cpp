// Curves, viscosity and relaxation on a block of irregular tets, against their closed forms.
#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/dynamics/forces.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/dynamics/system.h>
#include <coxa/fem/curve_material.h>
#include <coxa/fem/results.h>
#include <coxa/fem/viscoelastic_force.h>
#include <coxa/fem/viscous_force.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "cases.h"
#include "shapes.h"

namespace coxa::verify {
namespace {

/// Unit cube of irregular tets with its particles.
struct Cube {
  Cube() : mesh(fem::test::block(3, 3, 3, Vec3::Constant(1.0 / 3.0))) {
    Rng rng(5);
    for (Index i = 0; i < mesh.n_vertices(); ++i)
      for (int c = 0; c < 3; ++c) {
        double& value = mesh.points(i, c);
        const double shake = 0.06 * rng.uniform(-1, 1);
        if (value > 0.1 && value < 0.9) value += shake;
      }
    particles = {fem::test::stacked(mesh.points), VecX::Zero(mesh.points.size()),
                 VecX::Ones(mesh.n_vertices())};
  }
  bool on_face(Index i, int axis, double at) const {
    return std::abs(mesh.points(i, axis) - at) < 1e-9;
  }
  /// Slides the three coordinate planes on themselves and holds the face x = 1 along x.
  dynamics::Constraints free_sides() const {
    dynamics::Constraints constraints;
    for (Index i = 0; i < mesh.n_vertices(); ++i) {
      Vec3 free = Vec3::Ones();
      for (int c = 0; c < 3; ++c)
        if (on_face(i, c, 0.0)) free[c] = 0.0;
      if (on_face(i, 0, 1.0)) free[0] = 0.0;
      if (free.sum() < 3.0) constraints.add(i, free.asDiagonal(), Vec3::Zero());
    }
    return constraints;
  }
  void deform(const Mat3& F) { particles.x = fem::test::stacked(mesh.points * F.transpose()); }
  /// Force that holds the face x = 1, N.
  Vec3 holding_force(const dynamics::Force& force) const {
    const VecX f = dynamics::total_force({&force}, particles.x, particles.v);
    Vec3 sum = Vec3::Zero();
    for (Index i = 0; i < mesh.n_vertices(); ++i)
      if (on_face(i, 0, 1.0)) sum -= f.segment<3>(3 * i);
    return sum;
  }

  /// Mean x of the face x = 1.
  double face_position() const {
    double sum = 0.0;
    int count = 0;
    for (Index i = 0; i < mesh.n_vertices(); ++i)
      if (on_face(i, 0, 1.0)) {
        sum += particles.x[3 * i];
        ++count;
      }
    return sum / count;
  }

  TetMesh mesh;
  dynamics::Particles particles;
};

void relax(Cube& cube, const dynamics::Force& force) {
  const SolveReport report =
      dynamics::update_relax(cube.particles, {&force}, cube.free_sides(),
                             {.tolerance = 1e-10, .linear_solver = dynamics::LinearSolver::ldlt});
  if (!report.converged) fail(ErrorCode::no_convergence, "cube: ", report.reason);
}

fem::Curve stiffening(double scale) {
  return fem::Curve({-0.6, -0.2, 0.0, 0.2, 0.5},
                    {-9.0 * scale, -0.8 * scale, 0.0, 0.5 * scale, 4.0 * scale});
}

}  // namespace

Rows curves() {
  const auto modes = fem::six_modes({stiffening(1), stiffening(3), stiffening(2), stiffening(0.5),
                                     stiffening(0.7), stiffening(0.9)});
  Rows rows;
  const auto elastic = [](const Cube& cube, std::vector<fem::StrainMode> chosen) {
    return fem::ElasticForce(cube.mesh, fem::make_curve_material(std::move(chosen)));
  };
  for (const double l : {1.25, 0.85}) {  // sides free: without a volume curve they do not move
    Cube cube;
    const auto force = elastic(cube, modes);
    cube.deform(Vec3(l, 1.02, 0.97).asDiagonal());
    relax(cube, force);
    rows.push_back({join_text("six curves, stretch ", l, ": P, MPa"),
                    l * stiffening(1).value(0.5 * (l * l - 1.0)), cube.holding_force(force)[0],
                    0.01});
  }
  {
    Cube cube;
    const auto force = elastic(cube, modes);
    const double g = 0.3;  // y moves by g x: E_uv = g / 2, E_uu = g^2 / 2
    Mat3 F = Mat3::Identity();
    F(1, 0) = g;
    cube.deform(F);
    // from an element's stress: at the edges of the face the other faces pull too
    const Mat3 first_piola = force.cauchy_stress(cube.particles.x, 20) * F.inverse().transpose();
    rows.push_back({"six curves, shear 0.3: shear force, N",
                    stiffening(0.5).value(g) + g * stiffening(1).value(0.5 * g * g),
                    first_piola(1, 0), 0.01});
  }
  {
    Cube cube;
    auto with_volume = modes;
    with_volume.push_back(fem::volume_mode(stiffening(10)));
    const auto force = elastic(cube, with_volume);
    const double l = 0.9, e = 0.5 * (l * l - 1.0);
    cube.deform(Vec3(l, 1, 1).asDiagonal());
    rows.push_back({"volume curve, confined stretch 0.9: P, MPa",
                    l * (stiffening(1).value(e) + stiffening(10).value(e)),
                    cube.holding_force(force)[0], 0.01});
  }
  {
    Cube cube;
    const fem::Curve along = stiffening(1), volume = stiffening(5);
    const fem::ElasticForce force(cube.mesh, fem::make_rotated_curve_material(along, volume));
    for (const double l : {0.9, 0.75, 0.6, 0.5, 0.4}) {
      for (Index i = 0; i < cube.mesh.n_vertices(); ++i)
        if (cube.on_face(i, 0, 1.0)) cube.particles.x[3 * i] = l;
      relax(cube, force);
    }
    // the sides are free of stress: bisection for their stretch
    double low = 0.0, high = 0.5;
    for (int k = 0; k < 60; ++k) {
      const double side = 0.5 * (low + high);
      (along.value(side) + volume.value(-0.6 + 2.0 * side) > 0.0 ? high : low) = side;
    }
    rows.push_back({"rotated mode with curves, 60 % compression: P, MPa",
                    along.value(-0.6) + volume.value(-0.6 + 2.0 * low),
                    cube.holding_force(force)[0], 0.01});
  }
  return rows;
}

Rows strong_compression() {
  // between bonded plates, in ten steps to half the height
  Cube cube;
  const fem::ElasticForce force(cube.mesh, fem::make_corotational(fem::lame_from(12.0, 0.42)), {},
                                {.axes = {}, .tangent = fem::Tangent::positive});
  dynamics::Constraints constraints;
  for (Index i = 0; i < cube.mesh.n_vertices(); ++i)
    if (cube.on_face(i, 0, 0.0) || cube.on_face(i, 0, 1.0)) constraints.hold(i);
  for (int step = 1; step <= 10; ++step) {
    for (Index i = 0; i < cube.mesh.n_vertices(); ++i)
      cube.particles.x[3 * i] *= (1.0 - 0.05 * step) / (1.05 - 0.05 * step);
    const SolveReport report = dynamics::update_relax(cube.particles, {&force}, constraints,
                                                      {.tolerance = 1e-9, .max_iterations = 300});
    if (!report.converged) fail(ErrorCode::no_convergence, "compression: ", report.reason);
  }
  const VecX ratio = fem::compute_fields(force, cube.particles.x).volume_ratio;
  return {{"rotated mode, bonded block at half its height: inverted tets", 0.0,
           static_cast<double>((ratio.array() <= 0.0).count()), 0.0}};
}

Rows viscosity() {
  // a confined block creeps under a sudden small pressure: e(t) = p / M (1 - exp(-t M / eta))
  const fem::Lame lame = fem::lame_from(12.0, 0.42);
  const double M = lame.lambda + 2.0 * lame.mu, eta = 40.0, pressure = 1e-3 * M;
  Cube cube;
  const fem::ElasticForce elastic(cube.mesh, fem::make_st_venant_kirchhoff(lame));
  const fem::ViscousForce viscous(cube.mesh, {{fem::Vec6::Unit(0), fem::Curve::line(eta)}});
  dynamics::Constraints constraints;
  VecX load = VecX::Zero(cube.particles.x.size());
  const auto faces = faces_where(fem::test::with_mid_nodes(cube.mesh),
                                 [](const Vec3& X) { return X[0] > 1.0 - 1e-9; });
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const auto corner = [&](int a) { return Vec3(cube.mesh.points.row(faces(f, a))); };
    const double area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (int a = 0; a < 3; ++a) load[3 * faces(f, a)] -= pressure * area / 3.0;
  }
  for (Index i = 0; i < cube.mesh.n_vertices(); ++i)
    constraints.add(i, Vec3(cube.on_face(i, 0, 0.0) ? 0 : 1, 0, 0).asDiagonal(), Vec3::Zero());
  const dynamics::ConstantForce weight(load);
  cube.particles.mass.setConstant(1e-9);
  dynamics::Stepper stepper(cube.mesh.n_vertices(), {&elastic, &viscous, &weight});
  const double time = eta / M;
  for (int k = 0; k < 400; ++k)
    stepper.update_step(cube.particles, constraints,
                        {.integrator = dynamics::Integrator::backward_euler,
                         .time_step = time / 400,
                         .linear = {.tolerance = 1e-10}});
  Rows rows{{"creep of a confined block at its time constant: strain",
             1e-3 * (1.0 - std::exp(-1.0)), 1.0 - cube.face_position(), 0.01}};
  // and the curve itself at finite strain: P = l stress(l rate)
  const fem::Curve thinning({-9, -2, 0, 2, 9}, {-5, -3, 0, 3, 5});
  const fem::ViscousForce nonlinear(cube.mesh, {{fem::Vec6::Unit(0), thinning}});
  cube.deform(Vec3(0.8, 1, 1).asDiagonal());
  for (Index i = 0; i < cube.mesh.n_vertices(); ++i)
    cube.particles.v.segment<3>(3 * i) = Vec3(4.0 * cube.mesh.points(i, 0), 0, 0);
  rows.push_back({"rate curve at stretch 0.8, rate 4 1/s: P, MPa", 0.8 * thinning.value(0.8 * 4.0),
                  cube.holding_force(nonlinear)[0], 0.01});
  return rows;
}

Rows prony() {
  const std::vector<fem::PronyTerm> terms{{.share = 0.3, .time = 0.5}, {.share = 0.4, .time = 4.0}};
  const fem::Lame lame = fem::lame_from(12.0, 0.42);
  const double M = lame.lambda + 2.0 * lame.mu, rest = 0.3, e0 = 1e-5;
  Rows rows;
  // confined strain follows `strain`; calls `at_step(time, stress / M)` after every step
  const auto run = [&](double end, int steps, const auto& strain, const auto& at_step) {
    Cube cube;
    fem::ViscoelasticForce force(cube.mesh, fem::make_st_venant_kirchhoff(lame), terms);
    for (int k = 0; k <= steps; ++k) {
      const double t = end * k / steps;
      cube.deform(Vec3(1.0 + strain(t), 1, 1).asDiagonal());
      force.begin_step(k == 0 ? 0.0 : end / steps);
      force.end_step(cube.particles.x);
      at_step(t, force.cauchy_stress(cube.particles.x, 7)(0, 0) / M);
    }
  };
  double last = 0.0;
  const auto keep = [&](double, double stress) { last = stress; };
  run(
      3.0, 4, [&](double) { return e0; }, keep);
  double known = rest;
  for (const auto& term : terms) known += term.share * std::exp(-3.0 / term.time);
  rows.push_back({"step of strain, stress after 3 s / (M e)", known, last / e0, 0.005});

  run(
      2.0, 5, [&](double t) { return e0 * t / 2.0; }, keep);
  known = rest;
  for (const auto& term : terms)
    known += term.share * term.time / 2.0 * (1.0 - std::exp(-2.0 / term.time));
  rows.push_back({"ramp over 2 s, stress at its end / (M e)", known, last / e0, 0.005});

  // a sine of 1 Hz: the area of the last loop and the largest stress in it
  const double w = 2.0 * kPi;
  double storage = rest, loss = 0.0;
  for (const auto& term : terms) {
    const double r = w * term.time;
    storage += term.share * r * r / (1.0 + r * r);
    loss += term.share * r / (1.0 + r * r);
  }
  double area = 0.0, largest = 0.0, strain_before = 0.0, stress_before = 0.0;
  run(
      30.0, 12000, [&](double t) { return e0 * std::sin(w * t); },
      [&](double t, double stress) {
        const double strain = e0 * std::sin(w * t);
        if (t > 29.0 + 1e-9) {
          area += 0.5 * (stress + stress_before) * (strain - strain_before);
          largest = std::max(largest, stress);
          const int step = static_cast<int>(std::lround(t * 400.0));
          if (step % 50 == 0)  // eight points of the loop; tolerance of its amplitude
            rows.push_back({join_text("sine of 1 Hz at ", step % 400 / 400.0, " s: stress / (M e)"),
                            storage * std::sin(w * t) + loss * std::cos(w * t), stress / e0, 0.005,
                            "stress / (M e)", std::sin(w * t)});
        }
        strain_before = strain;
        stress_before = stress;
      });
  rows.push_back({"sine of 1 Hz, area of the loop / (M e^2)", kPi * loss, area / (e0 * e0), 0.005});
  rows.push_back({"sine of 1 Hz, amplitude of stress / (M e)", std::hypot(storage, loss),
                  largest / e0, 0.005});
  return rows;
}

}  // namespace coxa::verify
