// Free vibration: the lowest longitudinal frequency of a bar, and what each integrator does to the
// energy.
#include <coxa/dynamics/forces.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/dynamics/system.h>
#include <coxa/fem/elastic_force.h>

#include <cmath>

#include "cases.h"
#include "shapes.h"

namespace coxa::verify {
namespace {

// mm, MPa, tonne/mm3
constexpr double kLength = 40.0, kE = 12.0, kDensity = 1.1e-9;

struct Bar {
  Bar()
      : mesh(fem::test::block(40, 1, 1, Vec3::Ones())),
        elastic(mesh, fem::make_corotational(fem::lame_from(kE, 0.0))),
        particles{fem::test::stacked(mesh.points), VecX::Zero(mesh.points.size()),
                  fem::lumped_masses(mesh, kDensity, mesh.n_vertices())} {
    for (Index i = 0; i < mesh.n_vertices(); ++i) {
      if (mesh.points(i, 0) < 1e-9)
        constraints.hold(i);
      else
        constraints.add(i, Vec3(1, 0, 0).asDiagonal(), Vec3::Zero());
      // the shape of the lowest mode, small
      particles.x[3 * i] += 1e-3 * std::sin(0.5 * kPi * mesh.points(i, 0) / kLength);
    }
  }
  double tip() const {
    double sum = 0.0;
    for (Index i = 0; i < mesh.n_vertices(); ++i)
      if (mesh.points(i, 0) > kLength - 1e-9) sum += particles.x[3 * i] - kLength;
    return sum / 4.0;
  }
  double energy() const {
    return elastic.energy(particles.x) + dynamics::kinetic_energy(particles);
  }

  TetMesh mesh;
  fem::ElasticForce elastic;
  dynamics::Particles particles;
  dynamics::Constraints constraints;
};

constexpr solve::CgOptions kTight{.tolerance = 1e-12, .max_iterations = 4000};

/// Frequency from the times at which the tip passes through rest, Hz.
double measured_frequency() {
  Bar bar;
  const double h = 4.0 * kLength / std::sqrt(kE / kDensity) / 400.0;
  dynamics::Stepper stepper(bar.mesh.n_vertices(), {&bar.elastic});
  double before = bar.tip(), first = 0.0, last = 0.0;
  int crossings = 0;
  for (int k = 1; k <= 1000; ++k) {
    stepper.update_step(
        bar.particles, bar.constraints,
        {.integrator = dynamics::Integrator::implicit_midpoint, .time_step = h, .linear = kTight});
    const double now = bar.tip();
    if (before * now < 0.0) {
      last = h * (k - 1 + before / (before - now));
      if (crossings++ == 0) first = last;
    }
    before = now;
  }
  return 0.5 * (crossings - 1) / (last - first);
}

/// Energy after steps of a twentieth of the period, over the energy at the start.
double energy_kept(dynamics::Integrator integrator, int steps) {
  Bar bar;
  const double h = 4.0 * kLength / std::sqrt(kE / kDensity) / 20.0;
  const double start = bar.energy();
  dynamics::Stepper stepper(bar.mesh.n_vertices(), {&bar.elastic});
  for (int k = 0; k < steps; ++k)
    stepper.update_step(bar.particles, bar.constraints,
                        {.integrator = integrator, .time_step = h, .linear = kTight});
  return bar.energy() / start;
}

}  // namespace

Rows energy() {
  const double known = std::sqrt(kE / kDensity) / (4.0 * kLength);
  // backward Euler on a mode of frequency w: each step divides the energy by 1 + (w h)^2; after 25
  // periods the strain of 4e-5 would have sunk to rounding
  const double euler = std::pow(1.0 + std::pow(2.0 * kPi / 20.0, 2), -200);
  return {{"bar fixed at one end, lowest frequency, Hz", known, measured_frequency(), 0.01},
          {"implicit midpoint, 25 periods: energy kept", 1.0,
           energy_kept(dynamics::Integrator::implicit_midpoint, 500), 1e-6},
          {"backward Euler, 10 periods: log of the energy kept", std::log(euler),
           std::log(energy_kept(dynamics::Integrator::backward_euler, 200)), 0.01}};
}

}  // namespace coxa::verify
