#include <coxa/motion/bone_frames.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "sphere_region.h"

namespace coxa::motion {
namespace {

using LandmarkPoints = std::map<std::string, Vec3>;

// of one coordinate of an epicondyle found on a surface: where it is flat it may lie anywhere there
constexpr double kFoundSd = 3.0;  // mm

std::string suffix(Side side) { return side == Side::right ? "_right" : "_left"; }

// a landmark of one side: NAME_SIDE, or NAME alone for the hip's own side
std::optional<Vec3> landmark(const FrameLandmarks& landmarks, const std::string& name, Side of,
                             Side hip) {
  const auto known = landmarks.points.find(name + suffix(of));
  if (known != landmarks.points.end()) return known->second;
  const auto alone = landmarks.points.find(name);
  if (of == hip && alone != landmarks.points.end()) return alone->second;
  return std::nullopt;
}

Mat3 columns(const Vec3& x, const Vec3& y, const Vec3& z) {
  Mat3 R;
  R << x, y, z;
  return R;
}

// widest turn of axes that span `length` when each end is off by sd
double axis_interval(double sd, double length) { return 1.96 * std::sqrt(2.0) * sd / length; }

BoneFrame pelvis_frame(const FrameLandmarks& landmarks, Side side,
                       const BoneFrameOptions& options) {
  const auto asis_r = landmark(landmarks, "asis", Side::right, side),
             asis_l = landmark(landmarks, "asis", Side::left, side);
  const auto psis_r = landmark(landmarks, "psis", Side::right, side),
             psis_l = landmark(landmarks, "psis", Side::left, side);
  BoneFrame frame;
  if (asis_r && asis_l && (psis_r || psis_l)) {
    // one PSIS alone is as good for the plane up to its distance from the middle: move it there
    const Vec3 right = (*asis_r - *asis_l).normalized();
    Vec3 mid_psis = psis_r && psis_l ? Vec3(0.5 * (*psis_r + *psis_l)) : psis_r ? *psis_r : *psis_l;
    if (!(psis_r && psis_l)) mid_psis -= (mid_psis - 0.5 * (*asis_r + *asis_l)).dot(right) * right;
    frame.X_IB.R = pelvis_axes(*asis_r, *asis_l, mid_psis);
    frame.source = landmarks.source;
    frame.interval = axis_interval(landmarks.sd, (mid_psis - 0.5 * (*asis_r + *asis_l)).norm());
    return frame;
  }
  const auto asis = side == Side::right ? asis_r : asis_l,
             psis = side == Side::right ? psis_r : psis_l;
  if (asis && psis) {
    const Vec3 z = supine_axes().col(2);
    const Vec3 forward = *asis - *psis;
    const Vec3 x = (forward - forward.dot(z) * z).normalized();
    frame.X_IB.R = columns(x, z.cross(x), z);
    frame.source = landmarks.source + " (one side) and image axes";
    frame.interval =
        std::max(axis_interval(landmarks.sd, forward.norm()), 1.96 * options.positioning_sd);
    return frame;
  }
  frame.X_IB.R = supine_axes();
  frame.source = "image axes";
  frame.interval = 1.96 * options.positioning_sd;
  return frame;
}

// long axis to where the knee is expected, z from the neck turned back by the anteversion
BoneFrame shaft_and_neck_frame(const TriMesh& femur, const Vec3& centre, Side side,
                               const BoneFrameOptions& options) {
  const SurfaceSamples samples = surface_samples(femur);
  const double radius = fit_femoral_head(samples, centre, {}).radius;
  const ProximalFemurAxes axes = proximal_femur_axes(femur, centre, radius);
  const double along = (centre - axes.shaft_point).dot(axes.shaft_direction);
  const Vec3 end = axes.shaft_point + (along - options.femur_length) * axes.shaft_direction;
  // version is measured across the shaft, before its bow is allowed for
  const Vec3 y = (centre - end).normalized();
  const Vec3 lateral = (axes.neck_direction - axes.neck_direction.dot(y) * y).normalized();
  // the head stands in front of the condyles' axis, so the neck runs back: turn it forward again
  const double turn = side == Side::right ? options.mean_anteversion : -options.mean_anteversion;
  const Vec3 outward = rotation_from_vector(turn * y) * lateral;
  const Vec3 z = side == Side::right ? outward : Vec3(-outward);
  BoneFrame frame;
  // the shaft is bowed: its upper part points in front of the knee
  frame.X_IB.R =
      columns(y.cross(z), y, z) * rotation_from_vector(-options.mean_bow * Vec3::UnitZ());
  frame.source = join_text("shaft and neck (", std::lround(axes.shaft_length),
                           " mm of shaft; mean anteversion assumed)");
  frame.interval = 1.96 * options.anteversion_sd;
  return frame;
}

BoneFrame femur_frame(const SurfaceSet& surfaces, const FrameLandmarks& landmarks,
                      const Vec3& centre, Side side, const BoneFrameOptions& options,
                      LandmarkPoints& used, std::vector<std::string>& warnings) {
  const auto medial = landmark(landmarks, "medial_epicondyle", side, side);
  const auto lateral = landmark(landmarks, "lateral_epicondyle", side, side);
  BoneFrame frame;
  if (medial && lateral) {
    frame.X_IB.R = femur_axes(centre, *medial, *lateral, side);
    frame.source = landmarks.source;
    frame.interval = axis_interval(landmarks.sd, (*medial - *lateral).norm());
    return frame;
  }
  const auto femur = surfaces.find("femur");
  const bool there = femur != surfaces.end() && !femur->second.mesh.empty();
  if (const auto found =
          there ? find_epicondyles(femur->second.mesh, centre, side) : std::nullopt) {
    frame.X_IB.R = femur_axes(centre, found->medial, found->lateral, side);
    frame.source = "epicondyles found on the surface";
    frame.interval = axis_interval(kFoundSd, (found->medial - found->lateral).norm());
    used["medial_epicondyle" + suffix(side)] = found->medial;
    used["lateral_epicondyle" + suffix(side)] = found->lateral;
    return frame;
  }
  if (there) {
    try {
      return shaft_and_neck_frame(femur->second.mesh, centre, side, options);
    } catch (const Error& error) {
      warnings.push_back(std::string("femur's axes are the image's: ") + error.what());
    }
  }
  frame.X_IB.R = supine_axes();
  frame.source = "image axes";
  frame.interval = 1.96 * std::hypot(options.positioning_sd, options.anteversion_sd);
  return frame;
}

}  // namespace

Mat3 supine_axes() { return columns(-Vec3::UnitY(), Vec3::UnitZ(), -Vec3::UnitX()); }

Mat3 pelvis_axes(const Vec3& asis_right, const Vec3& asis_left, const Vec3& mid_psis) {
  const Vec3 across = asis_right - asis_left;
  require(across.norm() > 50.0, "the two ASIS are only ", across.norm(), " mm apart");
  const Vec3 z = across.normalized();
  const Vec3 forward = 0.5 * (asis_right + asis_left) - mid_psis;
  const Vec3 in_plane = forward - forward.dot(z) * z;
  require(in_plane.norm() > 30.0,
          "the PSIS lie on the line of the two ASIS; no pelvis plane is seen");
  const Vec3 x = in_plane.normalized();
  return columns(x, z.cross(x), z);
}

Mat3 femur_axes(const Vec3& joint_centre, const Vec3& medial_epicondyle,
                const Vec3& lateral_epicondyle, Side side) {
  const Vec3 y = (joint_centre - 0.5 * (medial_epicondyle + lateral_epicondyle)).normalized();
  const Vec3 outward = lateral_epicondyle - medial_epicondyle;
  const Vec3 right = side == Side::right ? outward : Vec3(-outward);
  const Vec3 in_plane = right - right.dot(y) * y;
  require(in_plane.norm() > 30.0, "the epicondyles are only ", in_plane.norm(),
          " mm apart across the femur");
  const Vec3 z = in_plane.normalized();
  return columns(y.cross(z), y, z);
}

BoneFrames make_bone_frames(const SurfaceSet& surfaces, const FrameLandmarks& landmarks,
                            const Vec3& joint_centre, Side side, const BoneFrameOptions& options) {
  require(options.femur_length > 0, "femur_length must be above 0 mm, got ", options.femur_length);
  BoneFrames frames;
  frames.pelvis = pelvis_frame(landmarks, side, options);
  for (const char* name : {"asis", "psis", "medial_epicondyle", "lateral_epicondyle"}) {
    for (const Side of : {Side::left, Side::right}) {
      if (const auto p = landmark(landmarks, name, of, side))
        frames.landmarks[name + suffix(of)] = *p;
    }
  }
  frames.femur = femur_frame(surfaces, landmarks, joint_centre, side, options, frames.landmarks,
                             frames.warnings);
  frames.pelvis.X_IB.p = joint_centre;
  frames.femur.X_IB.p = joint_centre;
  const double up = frames.pelvis.X_IB.R.col(1).dot(frames.femur.X_IB.R.col(1));
  const double right = frames.pelvis.X_IB.R.col(2).dot(frames.femur.X_IB.R.col(2));
  if (up < 0.5 || right < 0.5) {
    frames.warnings.push_back(
        "the axes of pelvis and femur differ by more than 60 degrees: are side and landmarks "
        "right?");
  }
  return frames;
}

}  // namespace coxa::motion
