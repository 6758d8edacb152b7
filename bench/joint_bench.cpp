// The hot paths of the joint on a ball in a cup of cartilage, about 10 and 21 thousand tetrahedra:
// search of contact pairs, one step led by hand, one frame of a simulation.
#include <coxa/collide/surface_contact.h>
#include <coxa/joint/live.h>

#include <benchmark/benchmark.h>

#include "joint/layers.h"
#include "joint/movements.h"

namespace {

using namespace coxa;

const joint::JointModel& hip() {
  static const joint::JointModel model =
      test::make_ball_in_cup({.cup_rings = 24, .head_rings = 34, .layers = 1});
  return model;
}

/// Both articular surfaces as the joint pairs them, the head pressed in by 0.1 mm.
struct Surfaces {
  VecX x;
  collide::SurfaceContact contact;

  Surfaces() : x(positions()), contact(make()) { contact.update_curvature(x); }
  static VecX positions() {
    const Points &socket = hip().acetabular_cartilage.points,
                 &head = hip().femoral_cartilage.points;
    VecX x(socket.size() + head.size());
    for (Index i = 0; i < socket.rows(); ++i) x.segment<3>(3 * i) = socket.row(i).transpose();
    for (Index i = 0; i < head.rows(); ++i)
      x.segment<3>(3 * (socket.rows() + i)) = head.row(i).transpose() + Vec3(0.0, 0.0, 0.1);
    return x;
  }
  static collide::SurfaceContact make() {
    const auto n = static_cast<Index>(hip().acetabular_cartilage.points.rows());
    const Triangles socket =
        joint::facets_with(hip().acetabular_cartilage, FacetTag::articular_side);
    const Triangles head = joint::facets_with(hip().femoral_cartilage, FacetTag::articular_side);
    return collide::SurfaceContact(collide::make_particle_surface(socket),
                                   collide::make_particle_surface((head.array() + n).matrix()),
                                   {.search_distance = 4.0,
                                    .facing = 0.35,
                                    .normal = collide::ContactNormal::smooth,
                                    .rule = collide::ContactRule::nodal});
  }
};

void detection(benchmark::State& state) {
  Surfaces s;
  for (auto _ : state) s.contact.update_pairs(s.x);
  state.counters["samples"] = s.contact.n_samples();
  state.counters["samples/s"] =
      benchmark::Counter(s.contact.n_samples(), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(detection)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void contact_force(benchmark::State& state) {
  Surfaces s;
  s.contact.update_pairs(s.x);
  VecX force = VecX::Zero(s.x.size());
  for (auto _ : state) s.contact.add_force(s.x, s.x, force);
  // what must be read: each constraint's stencil (a particle, a vector, a position)
  const double bytes = static_cast<double>(s.contact.stencil_particles().size()) * 76.0;
  state.counters["bytes/s"] = benchmark::Counter(
      bytes, benchmark::Counter::kIsIterationInvariantRate, benchmark::Counter::kIs1024);
}
BENCHMARK(contact_force)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void live_step(benchmark::State& state) {
  joint::LiveHip live(hip(), joint::passive_examination(hip(), 500.0));
  const double far = radians(40.0);
  double way = far;
  int iterations = 0, steps = 0;
  for (auto _ : state) {
    const auto step = live.step_towards({way, 0.0, 0.0});
    if (step.arrived) way = way > 0.0 ? -0.25 * far : far;
    iterations += step.frame.iterations;
    ++steps;
  }
  state.counters["newton"] = static_cast<double>(iterations) / steps;
}
BENCHMARK(live_step)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void frame(benchmark::State& state) {
  const auto motion = test::movement_to({radians(6.0), 0.0, 0.0}, 4);
  for (auto _ : state)
    benchmark::DoNotOptimize(joint::simulate(
        hip(), motion, joint::passive_examination(hip(), 500.0), {.centre_shift = std::nullopt}));
  state.counters["frames/s"] =
      benchmark::Counter(4.0, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(frame)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
