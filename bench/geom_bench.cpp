// Queries of the triangle tree on a closed surface of 20 480 triangles, at points within a few mm
// of it: what segmentation and contact ask.
#include <benchmark/benchmark.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>

#include "support/shapes.h"

namespace {

using namespace coxa;

const TriMesh& surface() {
  static const TriMesh mesh = test::icosphere(5, 25.0);
  return mesh;
}
const TriangleTree& tree() {
  static const TriangleTree built(surface().points, surface().triangles);
  return built;
}
Points queries() {
  Points points = test::random_points(1 << 14, 1.0, 5);
  for (Index i = 0; i < points.rows(); ++i)
    points.row(i) = (25.0 + 3.0 * points(i, 0)) * points.row(i).normalized();
  return points;
}

template <class Query>
void run(benchmark::State& state, const Query& query) {
  const Points points = queries();
  Index i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(query(Vec3(points.row(i))));
    i = (i + 1) % static_cast<Index>(points.rows());
  }
}

void build_tree(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(TriangleTree(surface().points, surface().triangles));
}
void update_points(benchmark::State& state) {
  TriangleTree moving = tree();
  for (auto _ : state) moving.update_points(surface().points);
}
void nearest(benchmark::State& state) {
  run(state, [](const Vec3& p) { return tree().nearest(p); });
}
void nearest_within_2_mm(benchmark::State& state) {
  run(state, [](const Vec3& p) { return tree().nearest_within(p, 2.0); });
}
void signed_distance(benchmark::State& state) {
  run(state, [](const Vec3& p) { return tree().signed_distance(p); });
}
void first_hit(benchmark::State& state) {
  run(state, [](const Vec3& p) { return tree().first_hit(p, p.normalized(), 10.0); });
}

}  // namespace

BENCHMARK(build_tree)->Unit(benchmark::kMillisecond);
BENCHMARK(update_points)->Unit(benchmark::kMillisecond);
BENCHMARK(nearest);
BENCHMARK(nearest_within_2_mm);
BENCHMARK(signed_distance);
BENCHMARK(first_hit);
