// A long random walk through the hip's range: how often a pose converges, whether anything is ever
// inverted, and how deep the cartilages overlap. Usage: joint_poses JOINT.toml [--poses 10000]
// [--seed 1] [--step 6] [--threads N]
#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>
#include <coxa/joint/simulate.h>
#include <coxa/pipeline/joint_stage.h>
#include <coxa/pipeline/motion_stage.h>

#include <Eigen/LU>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <string>

namespace {

using namespace coxa;

// degrees: flexion, adduction, internal rotation; the bones stop most of its corners
constexpr double kLow[3] = {-20.0, -40.0, -40.0}, kHigh[3] = {110.0, 25.0, 45.0};
constexpr int kPart = 250;  // poses that are held in memory at once

/// The next pose of a walk that turns back at the borders of the range.
motion::HipAngles walk(const motion::HipAngles& from, double step, Rng& rng) {
  const double now[3] = {degrees(from.flexion), degrees(from.adduction),
                         degrees(from.internal_rotation)};
  double next[3];
  for (int k = 0; k < 3; ++k) {
    next[k] = now[k] + step * rng.uniform(-1.0, 1.0);
    if (next[k] < kLow[k]) next[k] = 2.0 * kLow[k] - next[k];
    if (next[k] > kHigh[k]) next[k] = 2.0 * kHigh[k] - next[k];
  }
  return {radians(next[0]), radians(next[1]), radians(next[2])};
}

/// Least det F over the elements of a mesh moved to x.
double least_volume_ratio(const TetMesh& mesh, const Points& x) {
  double least = kInfinity;
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    Mat3 before, after;
    for (int k = 0; k < 3; ++k) {
      before.col(k) = (mesh.points.row(mesh.tets(t, k + 1)) - mesh.points.row(mesh.tets(t, 0)));
      after.col(k) = (x.row(mesh.tets(t, k + 1)) - x.row(mesh.tets(t, 0)));
    }
    least = std::min(least, after.determinant() / before.determinant());
  }
  return least;
}

struct Tally {
  int converged = 0, beyond = 0, failed = 0, inverted = 0;
  double penetration = 0.0, least_ratio = kInfinity, force_error = 0.0;
  std::map<std::string, int> reasons;  // by their first words

  void count(const joint::FrameResult& frame, const joint::JointModel& model) {
    if (frame.status == joint::FrameStatus::beyond_bony_limit) {
      ++beyond;
    } else if (frame.status == joint::FrameStatus::failed) {
      ++failed;
      ++reasons[frame.reason.substr(0, 26)];
      std::printf("failed at %.1f %.1f %.1f degrees: %s\n", degrees(frame.angles.flexion),
                  degrees(frame.angles.adduction), degrees(frame.angles.internal_rotation),
                  frame.reason.c_str());
    } else {
      ++converged;
      penetration = std::max(penetration, frame.contact.penetration);
      force_error = std::max(force_error, frame.balance.force_error);
      const TetMesh &socket = model.acetabular_cartilage, &head = model.femoral_cartilage;
      const double ratio =
          std::min(least_volume_ratio(socket, socket.points + frame.acetabular_displacement),
                   least_volume_ratio(
                       head, transformed(head.points, frame.X_II) + frame.femoral_displacement));
      least_ratio = std::min(least_ratio, ratio);
      inverted += ratio <= 0.0 ? 1 : 0;
    }
  }
  void print(int poses, double seconds) const {
    std::printf(
        "%d poses: %d converged, %d beyond the bony limit, %d failed; %d with an inverted "
        "element (least volume ratio %.3f); penetration at most %.4f mm, force error %.3f %%; "
        "%.0f s\n",
        poses, converged, beyond, failed, inverted, least_ratio, penetration, 100.0 * force_error,
        seconds);
    for (const auto& [reason, n] : reasons) std::printf("  %d times: %s\n", n, reason.c_str());
    std::fflush(stdout);
  }
};

}  // namespace

int main(int argc, char** argv) {
  try {
    require(argc > 1,
            "usage: joint_poses JOINT.toml [--poses N] [--seed N] [--step DEG] [--threads N]");
    int poses = 10000, seed = 1;
    double step = 6.0;
    for (int k = 2; k + 1 < argc; k += 2) {
      const std::string word = argv[k];
      if (word == "--poses") poses = std::stoi(argv[k + 1]);
      if (word == "--seed") seed = std::stoi(argv[k + 1]);
      if (word == "--step") step = std::stod(argv[k + 1]);
      if (word == "--threads") set_thread_count(std::stoi(argv[k + 1]));
    }
    const auto request = pipeline::read_joint_request(argv[1]);
    const joint::JointModel model = pipeline::read_joint_model(
        request, pipeline::read_motion_artefacts(request.motion, request.side).frames);
    const joint::LoadCase load = pipeline::joint_load(request, model);
    Rng rng(static_cast<std::uint64_t>(seed));
    Tally tally;
    motion::HipAngles angles;
    const auto start = std::chrono::steady_clock::now();
    for (int done = 0; done < poses;) {
      // each part starts from rest; a walk that has run into the bones starts there again too
      motion::HipMotion motion;
      angles = {};
      for (int k = 0; k < std::min(kPart, poses - done); ++k) {
        angles = walk(angles, step, rng);
        motion.time.push_back(k);
        motion.angles.push_back(angles);
        motion.X_PF.push_back({motion::rotation_from_angles(angles, model.side), Vec3::Zero()});
      }
      const auto result = joint::simulate(model, motion, load, {.centre_shift = std::nullopt});
      for (const joint::FrameResult& frame : result.frames) tally.count(frame, model);
      done += motion.n_frames();
      const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
      tally.print(done, seconds.count());
    }
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
