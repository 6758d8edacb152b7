// Tetrahedra for a lunate shell by the medial grid, and for a ball from the lattice.
#include <benchmark/benchmark.h>
#include <coxa/core/parallel.h>
#include <coxa/meshing/mesh_surface.h>

#include "support/shapes.h"

namespace {

using namespace coxa;

void mesh_of(benchmark::State& state, const TriMesh& surface,
             const meshing::MeshingOptions& options) {
  for (auto _ : state) {
    const auto made = with_threads(1, [&] { return meshing::mesh_surface(surface, options); });
    state.counters["tets"] = static_cast<double>(made.mesh.n_tets());
    state.counters["aspect_mean"] = made.report.quality.aspect_mean;
  }
}

void sheet(benchmark::State& state) {
  mesh_of(state, test::lunate_shell(),
          {.layers = static_cast<int>(state.range(0)), .max_tets = 20000});
}
BENCHMARK(sheet)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

void ten_nodes(benchmark::State& state) {
  mesh_of(state, test::lunate_shell(),
          {.max_tets = 20000, .order = meshing::ElementOrder::ten_node});
}
BENCHMARK(ten_nodes)->Unit(benchmark::kMillisecond);

void solid(benchmark::State& state) {
  mesh_of(state, test::icosphere(5, 25.0), {.max_tets = static_cast<int>(state.range(0))});
}
BENCHMARK(solid)->Arg(20000)->Arg(100000)->Unit(benchmark::kMillisecond);

}  // namespace
