// Flexion with internal rotation of one hip, timed: a simulation frame by frame, then the same way
// led by hand. Usage: joint_sweep JOINT.toml [--frames 100] [--flexion 60] [--rotation 27]
// [--no-sweep] [--no-live]; JOINT.toml as the chain leaves it in RUN/joint. Without the bones, so
// that every frame counts.
#include <coxa/core/error.h>
#include <coxa/joint/live.h>
#include <coxa/pipeline/joint_stage.h>
#include <coxa/pipeline/motion_stage.h>

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace coxa;

struct Way {
  int frames = 100;
  double flexion = 60.0, rotation = 27.0;  // degrees, at the end
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Processor time of all threads, s.
double processor_time() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

double largest_memory_mb() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

motion::HipAngles at(const Way& way, double share) {
  return {radians(share * way.flexion), 0.0, radians(share * way.rotation)};
}

motion::HipMotion movement(const Way& way, Side side) {
  motion::HipMotion motion;
  for (int k = 0; k < way.frames; ++k) {
    const double share = way.frames == 1 ? 0.0 : static_cast<double>(k) / (way.frames - 1);
    motion.time.push_back(share);
    motion.angles.push_back(at(way, share));
    motion.X_PF.push_back({motion::rotation_from_angles(at(way, share), side), Vec3::Zero()});
  }
  return motion;
}

void sweep(const joint::JointModel& model, const joint::LoadCase& load, const Way& way) {
  const auto start = std::chrono::steady_clock::now();
  const double processor = processor_time();
  const joint::JointResult result =
      joint::simulate(model, movement(way, model.side), load, {.centre_shift = std::nullopt});
  int iterations = 0;
  double force_error = 0.0;
  for (const joint::FrameResult& frame : result.frames) {
    iterations += frame.iterations;
    force_error = std::max(force_error, frame.balance.force_error);
    if (frame.status == joint::FrameStatus::failed)
      std::printf("frame %d failed: %s\n", frame.frame, frame.reason.c_str());
  }
  std::printf(
      "sweep: %d of %d frames converged, %.1f s (processor %.1f s), %d Newton steps, "
      "force error at most %.3f %%, %.0f MB\n",
      static_cast<int>(result.n_converged()), way.frames, seconds_since(start),
      processor_time() - processor, iterations, 100.0 * force_error, largest_memory_mb());
  const joint::FrameResult& last = result.frames.back();
  std::printf("last frame: p99 %.4f MPa, p95 %.4f, area %.2f mm2, translation %.5f %.5f %.5f mm\n",
              last.contact.peak_pressure_p99, last.contact.peak_pressure_p95,
              last.contact.contact_area, last.translation[0], last.translation[1],
              last.translation[2]);
}

void lead_by_hand(const joint::JointModel& model, const joint::LoadCase& load, const Way& way) {
  joint::LiveHip hip(model, load);
  std::vector<double> seconds;
  int failed = 0, iterations = 0;
  joint::LiveHip::Step step;
  const double processor = processor_time();
  do {
    step = hip.step_towards(at(way, 1.0));
    seconds.push_back(step.frame.seconds);
    iterations += step.frame.iterations;
    failed += step.frame.status == joint::FrameStatus::converged ? 0 : 1;
  } while (!step.arrived);
  double total = 0.0;
  for (const double s : seconds) total += s;
  std::sort(seconds.begin(), seconds.end());
  const auto n = seconds.size();
  std::printf(
      "live: %zu steps (%d failed, %d Newton steps), mean %.1f ms, median %.1f, 95th "
      "percentile %.1f; processor %.1f ms a step; %.1f steps/s\n",
      n, failed, iterations, 1e3 * total / static_cast<double>(n), 1e3 * seconds[n / 2],
      1e3 * seconds[n * 95 / 100], 1e3 * (processor_time() - processor) / static_cast<double>(n),
      static_cast<double>(n) / total);
  const joint::FrameResult exact = hip.settle().frame;
  const auto off = [](double live, double settled) { return 100.0 * (live / settled - 1.0); };
  const joint::ContactFigures &a = step.frame.contact, &b = exact.contact;
  std::printf(
      "live against settled at the end: p99 %+.1f %%, p95 %+.1f %%, area %+.1f %%, centre of "
      "pressure %.2f mm; settling took %.0f ms\n",
      off(a.peak_pressure_p99, b.peak_pressure_p99), off(a.peak_pressure_p95, b.peak_pressure_p95),
      off(a.contact_area, b.contact_area), (a.centre_of_pressure - b.centre_of_pressure).norm(),
      1e3 * exact.seconds);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    require(argc > 1,
            "usage: joint_sweep JOINT.toml [--frames N] [--flexion DEG] [--rotation DEG]");
    Way way;
    bool live = true, frames = true;
    for (int k = 2; k < argc; ++k) {
      const std::string word = argv[k];
      if (word == "--no-live") live = false;
      if (word == "--no-sweep") frames = false;
      if (k + 1 == argc) break;
      if (word == "--frames") way.frames = std::stoi(argv[++k]);
      if (word == "--flexion") way.flexion = std::stod(argv[++k]);
      if (word == "--rotation") way.rotation = std::stod(argv[++k]);
    }
    const auto request = pipeline::read_joint_request(argv[1]);
    const joint::JointModel model = pipeline::read_joint_model(
        request, pipeline::read_motion_artefacts(request.motion, request.side).frames);
    std::printf("%d + %d tetrahedra\n", static_cast<int>(model.acetabular_cartilage.n_tets()),
                static_cast<int>(model.femoral_cartilage.n_tets()));
    const joint::LoadCase load = pipeline::joint_load(request, model);
    if (frames) sweep(model, load, way);
    if (live) lead_by_hand(model, load, way);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
