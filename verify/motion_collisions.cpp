// Whether tracked poses make the bones of a real hip collide: docs/motion.md section 8.7.
#include <coxa/collide/rigid_pair.h>
#include <coxa/core/error.h>
#include <coxa/io/csv.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/markers.h>
#include <coxa/io/track_model.h>
#include <coxa/mesh/mirrored.h>
#include <coxa/motion/bone_frames.h>
#include <coxa/motion/joint_centre.h>
#include <coxa/motion/track.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "motion_cases.h"

namespace coxa::verify {

namespace fs = std::filesystem;

namespace {

Vec3 mirrored_point(const Vec3& p) { return {-p.x(), p.y(), p.z()}; }

/// Bones of one hip as a right hip, with its ISB frames.
struct BonesInFrames {
  collide::RigidPair pair;
  RigidTransform X_IP, X_IF;
  std::string sources;
};

// libhip's m1, whose left hip bone and femur are both from CT, as a right hip
BonesInFrames read_bones(const fs::path& shared) {
  const fs::path folder = shared / "data/libhip/m1/left";
  SurfaceSet hip;
  for (const char* bone : {"femur", "hip_bone"})
    hip[bone].mesh = mirrored(io::read_surface(folder / (std::string(bone) + ".ply")));
  motion::FrameLandmarks landmarks;
  const auto points = io::read_landmarks(folder / "landmarks.csv");
  landmarks.points["asis"] = mirrored_point(points.at("ASIS"));
  landmarks.points["psis"] = mirrored_point(points.at("PSIS"));
  SurfaceSet femur;
  femur["femur"] = hip["femur"];
  const Vec3 centre = motion::find_joint_centre(femur, {.congruency_samples = 0}).chosen.centre;
  const auto frames = motion::make_bone_frames(hip, landmarks, centre, Side::right);
  return {collide::RigidPair(hip["hip_bone"].mesh, hip["femur"].mesh), frames.pelvis.X_IB,
          frames.femur.X_IB, frames.pelvis.source + "; " + frames.femur.source};
}

// rotations of a truth file: columns hip_flex_deg hip_add_deg hip_introt_deg
std::vector<RigidTransform> read_truth(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  require(static_cast<bool>(std::getline(file, line)), path.string(), " cannot be read");
  const auto header = io::csv_cells(line);
  const auto column = [&](const char* name) {
    const auto it = std::find(header.begin(), header.end(), name);
    require(it != header.end(), path.string(), " has no column ", name);
    return static_cast<std::size_t>(it - header.begin());
  };
  const std::size_t flexion = column("hip_flex_deg"), adduction = column("hip_add_deg"),
                    rotation = column("hip_introt_deg");
  std::vector<RigidTransform> poses;
  while (std::getline(file, line)) {
    const auto cells = io::csv_cells(line);
    const auto angle = [&](std::size_t k) { return radians(std::stod(cells.at(k))); };
    const motion::HipAngles angles{angle(flexion), angle(adduction), angle(rotation)};
    poses.push_back({motion::rotation_from_angles(angles, Side::right), Vec3::Zero()});
  }
  return poses;
}

// clearance of the bones in every tenth frame, mm; negative: overlap
std::vector<double> clearances(const BonesInFrames& bones,
                               const std::vector<RigidTransform>& X_PF) {
  constexpr std::size_t kStride = 10;
  constexpr double kLimit = 15.0;  // mm
  std::vector<double> distances;
  for (std::size_t f = 0; f < X_PF.size(); f += kStride) {
    const RigidTransform X = bones.X_IP * X_PF[f] * bones.X_IF.inverse();
    distances.push_back(bones.pair.clearance(X, kLimit).distance);
  }
  return distances;
}

struct Collisions {
  Index frames = 0, in_contact = 0;  // looked at; of them with overlap
  Index new_contact = 0;             // with overlap where the true rotation has none
  double least = kInfinity;          // mm, clearance
  double new_overlap = 0.0;          // mm, deepest of the new contacts
};

void add(const std::vector<double>& distances, const std::vector<double>& truth, Collisions& sum) {
  require(distances.size() == truth.size(), "the truth has another number of frames");
  for (std::size_t k = 0; k < distances.size(); ++k) {
    sum.frames += 1;
    sum.least = std::min(sum.least, distances[k]);
    if (distances[k] >= 0) continue;
    sum.in_contact += 1;
    if (truth[k] < 0) continue;
    sum.new_contact += 1;
    sum.new_overlap = std::max(sum.new_overlap, -distances[k]);
  }
}

void print_row(const std::string& name, const Collisions& sum) {
  std::printf("| %s | %d of %d | %.2f | %d | %.2f |\n", name.c_str(), sum.in_contact, sum.frames,
              sum.least, sum.new_contact, sum.new_overlap);
}

}  // namespace

void print_collisions(const fs::path& shared, const std::vector<std::string>& trials) {
  const BonesInFrames bones = read_bones(shared);
  std::printf("frames: %s\n", bones.sources.c_str());
  constexpr motion::PoseMethod kMethods[] = {
      motion::PoseMethod::rigid, motion::PoseMethod::ball_joint, motion::PoseMethod::coxa};
  Collisions of_truth, tracked[std::size(kMethods)];
  for (const std::string& trial : trials) {
    const auto truth = clearances(bones, read_truth(trial + "_truth.csv"));
    add(truth, truth, of_truth);
    const auto markers = io::read_markers(trial + ".trc");
    motion::HipModel model = io::read_hip_model(trial + "_model.json");
    if (!model.calibration_frame) model.calibration_frame = 0;
    for (std::size_t k = 0; k < std::size(kMethods); ++k)
      add(clearances(bones, motion::track(markers, model, {.method = kMethods[k]}).X_PF), truth,
          tracked[k]);
  }
  std::printf(
      "| poses | frames with overlap | least clearance, mm | overlap where the truth has none | "
      "its depth, mm |\n|---|---|---|---|---|\n");
  print_row("true rotation about the centre", of_truth);
  for (std::size_t k = 0; k < std::size(kMethods); ++k)
    print_row(std::string(motion::name(kMethods[k])), tracked[k]);
}

}  // namespace coxa::verify
