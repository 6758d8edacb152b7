#include <coxa/geom/fits.h>
#include <coxa/shape/build_atlas.h>

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace coxa::shape {
namespace {

// Right hip, LPS, origin at the femoral head centre: lateral is -x, anterior -y, superior +z; mm.
using Rule = std::function<bool(const Vec3&)>;

/// The vertex farthest along `direction` among those the rule takes.
std::optional<Vec3> extreme(const TriMesh& mesh, const Vec3& direction, const Rule& takes) {
  std::optional<Vec3> best;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 p = mesh.points.row(v);
    if (takes(p) && (!best || p.dot(direction) > best->dot(direction))) best = p;
  }
  return best;
}

std::optional<Vec3> centroid(const TriMesh& mesh, const Rule& takes) {
  Vec3 sum = Vec3::Zero();
  int n = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 p = mesh.points.row(v);
    if (takes(p)) sum += p, ++n;
  }
  return n > 0 ? std::optional<Vec3>(sum / n) : std::nullopt;
}

void add(Landmarks& landmarks, const std::string& name, const std::optional<Vec3>& place) {
  if (place) landmarks[name] = *place;
}

/// Sphere through the upper medial part of the femur's end.
Vec3 head_centre(const TriMesh& femur) {
  std::vector<Vec3> cap;
  for (Index v = 0; v < femur.n_vertices(); ++v) {
    const Vec3 p = femur.points.row(v);
    if (p.norm() < 32.0 && p.dot(Vec3(0.6, -0.2, 0.77)) > 0.0) cap.push_back(p);
  }
  if (cap.size() < 4) return Vec3::Zero();
  Points points(static_cast<Index>(cap.size()), 3);
  for (Index i = 0; i < points.rows(); ++i) points.row(i) = cap[static_cast<std::size_t>(i)];
  return fit_sphere(points, {}, {.outlier_scale = 4.7}).centre;
}

void add_femur(const TriMesh& femur, Landmarks& landmarks) {
  const auto between = [](double low, double high) {
    return [low, high](const Vec3& p) { return low < p.z() && p.z() < high; };
  };
  landmarks["femoral_head_centre"] = head_centre(femur);
  // a sphere of 32 to 38 mm about the head's centre cuts the neck and nothing else
  add(landmarks, "femoral_neck_centre",
      centroid(femur, [](const Vec3& p) { return 32.0 < p.norm() && p.norm() < 38.0; }));
  add(landmarks, "greater_trochanter_tip",
      extreme(femur, Vec3::UnitZ(), [](const Vec3& p) { return p.x() < -32.0; }));
  const Vec3 medial_posterior = Vec3(0.6, 0.8, 0.0);
  add(landmarks, "lesser_trochanter_tip", extreme(femur, medial_posterior, between(-75.0, -45.0)));
  add(landmarks, "femoral_shaft_distal", centroid(femur, between(-112.0, -104.0)));
}

void add_hip_bone(const TriMesh& bone, Landmarks& landmarks) {
  add(landmarks, "asis", extreme(bone, -Vec3::UnitY(), [](const Vec3& p) { return p.z() > 45.0; }));
  add(landmarks, "aiis", extreme(bone, -Vec3::UnitY(), [](const Vec3& p) {
        return 15.0 < p.z() && p.z() < 42.0 && p.x() < 15.0;
      }));
  add(landmarks, "psis", extreme(bone, Vec3::UnitY(), [](const Vec3& p) { return p.z() > 30.0; }));
  add(landmarks, "pubic_tubercle",
      extreme(bone, -Vec3::UnitY(), [](const Vec3& p) { return p.x() > 40.0 && p.z() < 10.0; }));
  add(landmarks, "ischial_tuberosity",
      extreme(bone, -Vec3::UnitZ(), [](const Vec3&) { return true; }));
}

}  // namespace

Landmarks find_landmarks(const std::map<std::string, TriMesh>& mean_surfaces) {
  Landmarks landmarks;
  if (const auto it = mean_surfaces.find("femur"); it != mean_surfaces.end())
    add_femur(it->second, landmarks);
  if (const auto it = mean_surfaces.find("hip_bone"); it != mean_surfaces.end())
    add_hip_bone(it->second, landmarks);
  if (const auto it = mean_surfaces.find("acetabular_cartilage"); it != mean_surfaces.end()) {
    // where the weight-bearing edge of the socket meets the frontal plane through the head
    add(landmarks, "acetabular_rim_superior",
        extreme(it->second, -Vec3::UnitX(),
                [](const Vec3& p) { return std::abs(p.y()) < 5.0 && p.z() > 0.0; }));
  }
  return landmarks;
}

}  // namespace coxa::shape
