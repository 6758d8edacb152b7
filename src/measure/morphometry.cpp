#include <coxa/measure/morphometry.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/measure/hip_angles.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace coxa::measure {
namespace {

// rim points are looked for in this many directions about the socket's axis
constexpr Index kRimBins = 36;
// of them at least this many must hold a part of the socket
constexpr Index kLeastRim = 12;
constexpr int kRimRounds = 4;
// alpha angles are looked for up to here: beyond lies the part of the head that meets the socket
constexpr double kLargestAlpha = radians(90.0);
// a head that is no exact sphere leaves it only beyond so many of its own deviations
constexpr double kDeviations = 2.0;

/// The point farthest towards the opening in every direction about the axis that has any.
Points rim_points(const TriMesh& socket, const Vec3& centre, const Vec3& axis) {
  const Vec3 across = axis.unitOrthogonal(), up = axis.cross(across);
  std::array<std::optional<Index>, kRimBins> farthest;
  std::array<double, kRimBins> height;
  height.fill(-kInfinity);
  for (Index v = 0; v < socket.n_vertices(); ++v) {
    const Vec3 arm = (socket.points.row(v).transpose() - centre).normalized();
    const double turn = std::atan2(arm.dot(up), arm.dot(across)) / (2.0 * kPi) + 0.5;
    const auto bin = static_cast<std::size_t>(std::min<double>(kRimBins - 1, turn * kRimBins));
    if (arm.dot(axis) <= height[bin]) continue;
    height[bin] = arm.dot(axis);
    farthest[bin] = v;
  }
  std::vector<Index> rim;
  for (const auto& vertex : farthest) {
    if (vertex) rim.push_back(*vertex);
  }
  require(static_cast<Index>(rim.size()) >= kLeastRim, "the socket's rim is seen in only ",
          rim.size(), " of ", kRimBins, " directions; at least ", kLeastRim, " are needed");
  return socket.points(rim, Eigen::all);
}

void measure_alpha(const TriMesh& femur, const Sphere& head, const motion::ProximalFemurAxes& axes,
                   const Vec3& anterior, Morphometry& result) {
  // 12 and 3 o'clock about the neck: in the plane of neck and shaft, and across it
  const Vec3 neck = axes.neck_direction;
  Vec3 three = neck.cross(axes.shaft_direction).normalized();
  if (three.dot(anterior) < 0.0) three = -three;
  Vec3 twelve = neck.cross(three).normalized();
  if (twelve.dot(axes.shaft_direction) < 0.0) twelve = -twelve;
  AlphaAngleOptions options;
  options.tolerance = std::max(options.tolerance, kDeviations * head.rms);
  options.largest = kLargestAlpha;
  Index unclear = 0;
  for (Index hour = 0; hour < 12; ++hour) {
    const double turn = 2.0 * kPi * hour / 12.0;
    double alpha =
        alpha_angle(femur, head, neck, std::cos(turn) * twelve + std::sin(turn) * three, options);
    // outside from the beginning: the sphere is not this side's, and no angle can be told
    if (alpha >= kLargestAlpha) {
      alpha = kNaN;
      ++unclear;
    }
    result.alpha_angle[static_cast<std::size_t>(hour)] = alpha;
    if (!(alpha <= result.largest_alpha_angle)) {
      if (std::isnan(alpha)) continue;
      result.largest_alpha_angle = alpha;
      result.largest_alpha_hour = hour;
    }
  }
  if (unclear > 0) {
    result.notes.push_back(join_text(unclear, " of 12 alpha angles cannot be told: the head lies ",
                                     options.tolerance,
                                     " mm outside its sphere 90 degrees from the neck"));
  }
}

void measure_femur(const TriMesh& femur, const motion::BoneFrame& frame,
                   const motion::JointCentre& head, Side side, Morphometry& result) {
  result.head_radius = head.radius;
  result.head_rms = head.rms;
  motion::ProximalFemurAxes axes;
  try {
    axes = motion::proximal_femur_axes(femur, head.centre, head.radius);
  } catch (const Error& error) {
    result.notes.push_back(std::string("no angles of the femur: ") + error.what());
    return;
  }
  result.neck_shaft_angle =
      neck_shaft_angle(head.centre, head.centre + axes.neck_direction, -axes.shaft_direction);
  measure_alpha(femur, {head.centre, head.radius, head.rms}, axes, frame.X_IB.R.col(0), result);
  if (frame.source != "landmarks") {
    result.notes.push_back("no femoral version: the femur's frame comes from " + frame.source +
                           ", not from both epicondyles");
    return;
  }
  const Vec3 to_head_F = -(frame.X_IB.R.transpose() * axes.neck_direction);
  const double medial = side == Side::right ? -to_head_F.z() : to_head_F.z();
  result.femoral_version = std::atan2(to_head_F.x(), medial);
}

void measure_socket(const TriMesh& socket, const RigidTransform& X_IP, const Vec3& centre,
                    Side side, Morphometry& result) {
  const Vec3 axis = socket_axis(socket, centre);
  result.socket = make_clock_face(centre, axis, X_IP.R.col(1), X_IP.R.col(0));
  const auto orientation = acetabular_orientation(X_IP.R.transpose() * axis, side);
  result.acetabular_inclination = orientation.inclination;
  result.acetabular_version = orientation.version;
  const RigidTransform X_PI = X_IP.inverse();
  const TriMesh socket_P{transformed(socket.points, X_PI), socket.triangles};
  const Vec3 centre_P = X_PI * centre;
  try {
    result.lateral_centre_edge_angle =
        lateral_centre_edge_angle(centre_P, find_lateral_edge(socket_P, centre_P, side), side);
  } catch (const Error& error) {
    result.notes.push_back(std::string("no lateral centre-edge angle: ") + error.what());
  }
}

}  // namespace

Vec3 socket_axis(const TriMesh& socket, const Vec3& centre) {
  require(!socket.empty(), "the socket has no triangle");
  const Vec3 towards = (socket.points.rowwise() - centre.transpose()).colwise().mean();
  require(towards.norm() > 1e-3, "the socket closes around the head's centre: it has no opening");
  Vec3 axis = -towards.normalized();
  for (int round = 0; round < kRimRounds; ++round) {
    const Vec3 normal = fit_plane(rim_points(socket, centre, axis)).normal;
    axis = normal.dot(axis) > 0.0 ? normal : Vec3(-normal);
  }
  return axis;
}

Morphometry hip_morphometry(const SurfaceSet& surfaces, const motion::BoneFrames& frames,
                            const motion::JointCentre& head, Side side) {
  Morphometry result;
  result.alpha_angle.fill(kNaN);
  if (const auto femur = surfaces.find("femur"); femur != surfaces.end()) {
    measure_femur(femur->second.mesh, frames.femur, head, side, result);
  } else {
    result.notes.push_back("no femur: nothing of it is measured");
  }
  if (const auto socket = surfaces.find("acetabular_cartilage"); socket != surfaces.end()) {
    measure_socket(socket->second.mesh, frames.pelvis.X_IB, head.centre, side, result);
  } else {
    result.notes.push_back("no acetabular cartilage: nothing of the socket is measured");
  }
  return result;
}

}  // namespace coxa::measure
