#include <coxa/pipeline/frame_picture.h>

namespace coxa::pipeline {
namespace {

using motion::HipAngles;

constexpr Index kPelvis = 0, kFemur = 1, kTurns = 2;  // groups of arrows
constexpr double kAxisLength = 100.0;                 // mm

void add_axes(const motion::BoneFrame& frame, const char* bone, Index group, double length,
              std::vector<view::Arrow>& arrows) {
  constexpr const char* kNames[] = {"x anterior", "y superior", "z right"};
  for (int axis = 0; axis < 3; ++axis) {
    Points path(2, 3);
    path.row(0) = frame.X_IB.p;
    path.row(1) = frame.X_IB.p + length * frame.X_IB.R.col(axis);
    arrows.push_back({path, std::string(bone) + " " + kNames[axis], group});
  }
}

/// The way of a point of the thigh when one angle grows from 0 to 35 degrees.
view::Arrow turn(const motion::BoneFrames& frames, Side side, const Vec3& p_F,
                 double HipAngles::*angle, const char* label) {
  constexpr Index kSteps = 16;
  const double largest = radians(35.0);
  view::Arrow arrow{Points(kSteps + 1, 3), label, kTurns};
  for (Index k = 0; k <= kSteps; ++k) {
    HipAngles angles;
    angles.*angle = largest * k / kSteps;
    arrow.path.row(k) = frames.pelvis.X_IB * (motion::rotation_from_angles(angles, side) * p_F);
  }
  return arrow;
}

}  // namespace

view::Image draw_bone_frames(const SurfaceSet& surfaces, const motion::BoneFrames& frames,
                             Side side) {
  view::SurfacePictureOptions options{
      .viewpoints = {view::Viewpoint::anterior,
                     side == Side::right ? view::Viewpoint::right : view::Viewpoint::left,
                     view::Viewpoint::superior},
      .panel = 460};
  SurfaceSet bones;
  for (const char* name : {"femur", "hip_bone"}) {
    const auto it = surfaces.find(name);
    if (it == surfaces.end() || it->second.mesh.empty()) continue;
    bones[name].mesh = it->second.mesh;
    options.see_through.push_back(name);
  }
  add_axes(frames.pelvis, "pelvis", kPelvis, kAxisLength, options.arrows);
  add_axes(frames.femur, "femur", kFemur, 0.75 * kAxisLength, options.arrows);
  const double lateral = side == Side::right ? 1.0 : -1.0;
  options.arrows.push_back(turn(frames, side, Vec3(0, -130, 0), &HipAngles::flexion, "flexion +"));
  options.arrows.push_back(
      turn(frames, side, Vec3(0, -150, 0), &HipAngles::adduction, "adduction +"));
  options.arrows.push_back(turn(frames, side, Vec3(60, -100, 20 * lateral),
                                &HipAngles::internal_rotation, "internal rotation +"));
  return view::draw_surfaces(bones, options);
}

view::LinePlot angle_plot(const motion::HipMotion& motion) {
  const Index n = motion.n_frames();
  const bool with_interval = motion.interval.size() == motion.angles.size();
  view::LinePlot plot{
      .title = "Hip angles", .x_label = "time (s)", .y_label = "degrees", .series = {}};
  const VecX time = Eigen::Map<const VecX>(motion.time.data(), n);
  const auto add = [&](const std::string& label, double HipAngles::*angle) {
    VecX value(n), half = VecX::Zero(n);
    for (Index f = 0; f < n; ++f) {
      const auto k = static_cast<std::size_t>(f);
      value[f] = degrees(motion.angles[k].*angle);
      if (with_interval) half[f] = degrees(motion.interval[k].*angle);
    }
    plot.series.push_back({label, time, value});
    if (with_interval)
      plot.bands.push_back({label + ", 95 % interval", time, value - half, value + half});
  };
  add("flexion", &HipAngles::flexion);
  add("adduction", &HipAngles::adduction);
  add("internal rotation", &HipAngles::internal_rotation);
  return plot;
}

}  // namespace coxa::pipeline
