#include <benchmark/benchmark.h>
#include <coxa/core/parallel.h>
#include <coxa/motion/track.h>

#include "motion/synthetic_hip.h"

// Frames per second of every pose method, intervals included, on one core: a trial of 2000 frames
// with eight thigh markers that each move over the bone by 2 to 9 mm.
namespace {

using namespace coxa;
using namespace coxa::motion;

test::SyntheticHip moving_skin(Index n_frames) {
  auto hip = test::make_hip(n_frames, 0.3);
  Rng rng(11);
  for (std::size_t m = 4; m < hip.markers.trajectories.size(); ++m) {
    const double size = 2.0 + static_cast<double>(m - 4);
    const Vec3 by_flexion = size * rng.normal3(), by_rotation = size * rng.normal3();
    for (Index f = 0; f < n_frames; ++f) {
      const HipAngles& a = hip.angles[static_cast<std::size_t>(f)];
      hip.markers.trajectories[m].row(f) +=
          a.flexion * by_flexion + a.internal_rotation * by_rotation;
    }
  }
  return hip;
}

void track_one_trial(benchmark::State& state) {
  const auto method = static_cast<PoseMethod>(state.range(0));
  constexpr Index kFrames = 2000;
  const auto hip = moving_skin(kFrames);
  with_threads(1, [&] {
    for (auto _ : state)
      benchmark::DoNotOptimize(track(hip.markers, hip.model, {.method = method}));
    return 0;
  });
  state.SetLabel(std::string(name(method)));
  state.SetItemsProcessed(state.iterations() * kFrames);  // frames
}
BENCHMARK(track_one_trial)->DenseRange(0, 5)->Unit(benchmark::kMillisecond);

}  // namespace
