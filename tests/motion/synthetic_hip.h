#pragma once

#include <coxa/core/rng.h>
#include <coxa/geom/fits.h>
#include <coxa/motion/track.h>

#include <cmath>

namespace coxa::motion::test {

/// A right hip with eight thigh and four pelvis markers and known movement.
struct SyntheticHip {
  HipModel model;
  MarkerData markers;
  std::vector<HipAngles> angles;
  Points head_lab;
};

/// @param noise  mm, independent per coordinate, marker and frame
inline SyntheticHip make_hip(Index n_frames, double noise = 0.0, Side side = Side::right,
                             std::uint64_t seed = 5) {
  SyntheticHip hip;
  Rng rng(seed);
  hip.model.side = side;
  const double s = side == Side::right ? 1.0 : -1.0;
  hip.model.joint_centre_pelvis = Vec3(-20, -80, s * 85);
  hip.model.joint_centre_femur = Vec3(3, 400, -2);
  hip.model.pelvis_markers = {{"LASI", Vec3(40, 0, -110)},
                              {"RASI", Vec3(40, 0, 110)},
                              {"LPSI", Vec3(-120, 10, -45)},
                              {"RPSI", Vec3(-120, 10, 45)}};
  for (int k = 0; k < 8; ++k) {
    const double a = 0.8 * k, depth = 90.0 + 35.0 * k;
    hip.model.thigh_markers["T" + std::to_string(k)] =
        hip.model.joint_centre_femur + Vec3(70 * std::cos(a), -depth, s * 70 * std::sin(a));
  }
  std::vector<Vec3> sites;
  std::vector<bool> on_pelvis;
  for (const auto& [label, p] : hip.model.pelvis_markers) {
    hip.markers.labels.push_back(label);
    sites.push_back(p);
    on_pelvis.push_back(true);
  }
  for (const auto& [label, p] : hip.model.thigh_markers) {
    hip.markers.labels.push_back(label);
    sites.push_back(p);
    on_pelvis.push_back(false);
  }
  hip.markers.rate = 100.0;
  hip.markers.trajectories.assign(sites.size(), Points(n_frames, 3));
  hip.head_lab.resize(n_frames, 3);
  for (Index f = 0; f < n_frames; ++f) {
    const double u = 2 * kPi * f / n_frames;
    const HipAngles angles{0.6 - 0.6 * std::cos(u), 0.3 * std::sin(2 * u), 0.4 * std::sin(3 * u)};
    hip.angles.push_back(angles);
    const RigidTransform X_LP{rotation_from_vector(Vec3(0.2 * std::sin(u), 1.0, 0.1)),
                              Vec3(100 * u, 900, -50)};
    const RigidTransform X_PF{rotation_from_angles(angles, side), hip.model.joint_centre_pelvis};
    hip.head_lab.row(f) = X_LP * hip.model.joint_centre_pelvis;
    for (std::size_t m = 0; m < sites.size(); ++m) {
      const Vec3 p = on_pelvis[m] ? X_LP * sites[m]
                                  : X_LP * (X_PF * (sites[m] - hip.model.joint_centre_femur));
      hip.markers.trajectories[m].row(f) = p + noise * rng.normal3();
    }
  }
  return hip;
}

/// Root mean square over frames of the three angles' errors, rad.
inline Vec3 rms_error(const HipMotion& motion, const std::vector<HipAngles>& truth) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t f = 0; f < truth.size(); ++f) {
    const HipAngles &a = motion.angles[f], &b = truth[f];
    sum += Vec3(a.flexion - b.flexion, a.adduction - b.adduction,
                a.internal_rotation - b.internal_rotation)
               .cwiseAbs2();
  }
  return (sum / static_cast<double>(truth.size())).cwiseSqrt();
}

}  // namespace coxa::motion::test
