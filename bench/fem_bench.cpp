// The hot paths of mechanics on a thin shell of about 20 000 tets, bonded at its base: a cartilage
// in size and shape.
#include <benchmark/benchmark.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/dynamics/system.h>
#include <coxa/fem/mean_dilatation.h>
#include <coxa/fem/results.h>
#include <coxa/solve/sparse_ldlt.h>

#include <cmath>

#include "fem/shapes.h"

namespace {

using namespace coxa;

// a cap of a ball of 25 mm, 1.8 mm thick in three layers: 33 x 33 x 3 cells of six tets
TetMesh shell() {
  TetMesh mesh = fem::test::block(33, 33, 3, Vec3(1.0 / 33, 1.0 / 33, 0.6));
  for (Index i = 0; i < mesh.n_vertices(); ++i) {
    const double a = radians(90.0) * (mesh.points(i, 0) - 0.5);
    const double b = radians(90.0) * (mesh.points(i, 1) - 0.5);
    const Vec3 direction = Vec3(std::tan(a), std::tan(b), 1.0).normalized();
    mesh.points.row(i) = (25.0 + mesh.points(i, 2)) * direction.transpose();
  }
  return mesh;
}

std::unique_ptr<fem::Material> law(int number) {
  const fem::Lame lame = fem::lame_from(12.0, 0.42);
  switch (number) {
    case 0:
      return fem::make_st_venant_kirchhoff(lame);
    case 1:
      return fem::make_neo_hookean(lame);
    case 2:
      return fem::make_corotational(lame);
    default:
      return fem::make_veronda_westmann(0.8, 5.0, 30.0);
  }
}
const char* law_name(int number) {
  constexpr const char* kNames[] = {"St-Venant-Kirchhoff", "neo-Hookean", "corotational",
                                    "Veronda-Westmann"};
  return kNames[number];
}

struct Shell {
  explicit Shell(int law_number, fem::Tangent tangent = fem::Tangent::exact)
      : mesh(shell()),
        elastic(mesh, law(law_number), {}, {.tangent = tangent}),
        x(fem::test::stacked(mesh.points)),
        v(VecX::Zero(x.size())),
        A(mesh.n_vertices(), elastic.pattern()) {
    Rng rng(1);
    for (Index i = 0; i < mesh.n_vertices(); ++i) {
      if (mesh.points.row(i).norm() < 25.0 + 1e-9)
        constraints.hold(i);
      else
        x.segment<3>(3 * i) += 0.02 * rng.normal3();
    }
  }
  TetMesh mesh;
  fem::ElasticForce elastic;
  VecX x, v;
  solve::BlockMatrix A;
  dynamics::Constraints constraints;
};

void force(benchmark::State& state) {
  const Shell s(static_cast<int>(state.range(0)));
  VecX f = VecX::Zero(s.x.size());
  for (auto _ : state) s.elastic.add_force(s.x, s.v, f);
  state.SetLabel(law_name(static_cast<int>(state.range(0))));
  state.counters["tets/s"] =
      benchmark::Counter(s.mesh.n_tets(), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(force)
    ->DenseRange(0, 3)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void jacobian(benchmark::State& state) {
  Shell s(static_cast<int>(state.range(0)),
          state.range(1) == 0 ? fem::Tangent::exact : fem::Tangent::positive);
  for (auto _ : state) {
    s.A.set_zero();
    s.elastic.add_jacobian(s.x, s.v, 1.0, 0.0, s.A);
  }
  state.SetLabel(std::string(law_name(static_cast<int>(state.range(0)))) +
                 (state.range(1) == 0 ? "" : ", positive"));
  state.counters["tets/s"] =
      benchmark::Counter(s.mesh.n_tets(), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(jacobian)
    ->ArgsProduct({{0, 1, 2, 3}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void multiply(benchmark::State& state) {
  Shell s(0);
  s.elastic.add_jacobian(s.x, s.v, 1.0, 0.0, s.A);
  VecX y;
  for (auto _ : state) s.A.multiply(s.x, y);
  // what must come from memory: each block and column once, x and y once
  const double bytes = static_cast<double>(s.A.blocks().size()) * 76.0 + 48.0 * s.A.n();
  state.counters["bytes/s"] = benchmark::Counter(
      bytes, benchmark::Counter::kIsIterationInvariantRate, benchmark::Counter::kIs1024);
}
BENCHMARK(multiply)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void conjugate_gradient(benchmark::State& state) {
  Shell s(1, fem::Tangent::positive);
  s.elastic.add_jacobian(s.x, s.v, 1.0, 0.0, s.A);
  const VecX b = dynamics::total_force({&s.elastic}, s.x, s.v);
  SolveReport report;
  for (auto _ : state) {
    VecX dx = VecX::Zero(b.size());
    report = solve::conjugate_gradient(s.A, b, dx, {.tolerance = 1e-6},
                                       [&](VecX& values) { s.constraints.filter(values); });
  }
  state.counters["iterations"] = report.iterations;
}
BENCHMARK(conjugate_gradient)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void direct_solve(benchmark::State& state) {
  Shell s(1, fem::Tangent::positive);
  s.elastic.add_jacobian(s.x, s.v, 1.0, 0.0, s.A);
  dynamics::update_constrained(s.constraints, s.A);
  const VecX b = dynamics::total_force({&s.elastic}, s.x, s.v);
  solve::SparseLdlt solver;
  solver.factorize(s.A);
  for (auto _ : state) {
    solver.factorize(s.A);
    benchmark::DoNotOptimize(solver.solve(b));
  }
}
BENCHMARK(direct_solve)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

// one linearised step of backward Euler, 1 ms, as in the live examination
void step(benchmark::State& state) {
  Shell s(1, fem::Tangent::positive);
  dynamics::Particles particles{s.x, s.v, fem::lumped_masses(s.mesh, 1.1e-9, s.mesh.n_vertices())};
  dynamics::Stepper stepper(s.mesh.n_vertices(), {&s.elastic});
  for (auto _ : state)
    stepper.update_step(particles, s.constraints, {.linear = {.tolerance = 1e-3}});
}
BENCHMARK(step)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void fields(benchmark::State& state) {
  const Shell s(1);
  for (auto _ : state) benchmark::DoNotOptimize(fem::compute_fields(s.elastic, s.x));
}
BENCHMARK(fields)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
