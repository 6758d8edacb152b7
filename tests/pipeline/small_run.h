#pragma once

#include <coxa/io/files.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/tets.h>
#include <coxa/io/volumes.h>
#include <coxa/pipeline/record.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "joint/layers.h"

/// A hip of spheres and cones, small enough that every stage of a run takes about a second.
namespace coxa::test {

/// Closed surface of revolution about the x axis through `profile` (x, radius), outward.
inline TriMesh revolved(const std::vector<Vec2>& profile, Index around) {
  const auto rings = static_cast<Index>(profile.size());
  TriMesh mesh;
  mesh.points.resize(rings * around + 2, 3);
  for (Index r = 0; r < rings; ++r) {
    const Vec2& p = profile[static_cast<std::size_t>(r)];
    for (Index k = 0; k < around; ++k) {
      const double turn = 2.0 * kPi * k / around;
      mesh.points.row(r * around + k) << p.x(), p.y() * std::cos(turn), p.y() * std::sin(turn);
    }
  }
  const Index first = rings * around, last = first + 1;
  mesh.points.row(first) << profile.front().x(), 0, 0;
  mesh.points.row(last) << profile.back().x(), 0, 0;
  std::vector<Eigen::RowVector3i> triangles;
  for (Index k = 0; k < around; ++k) {
    const Index next = (k + 1) % around;
    triangles.emplace_back(first, next, k);
    triangles.emplace_back(last, (rings - 1) * around + k, (rings - 1) * around + next);
    for (Index r = 0; r + 1 < rings; ++r) {
      const Index a = r * around + k, b = r * around + next;
      triangles.emplace_back(a, b, b + around);
      triangles.emplace_back(a, b + around, a + around);
    }
  }
  mesh.triangles.resize(static_cast<Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    mesh.triangles.row(static_cast<Index>(t)) = triangles[t];
  return mesh;
}

// of the small hip, mm and rad; its joint centre is the origin, LPS axes, a right hip
inline constexpr double kHeadRadius = 23.0, kNeckRadius = 14.0;
inline constexpr double kSocketRadius = 26.0, kSocketAngle = radians(60.0);
inline constexpr double kNeckTilt = radians(45.0);  ///< below the horizontal, in the coronal plane

/// A head on a cylindrical neck that points to the right (of the patient) and down.
inline TriMesh small_femur(double neck_length = 45.0) {
  std::vector<Vec2> profile;
  const double neck_from = std::acos(-std::sqrt(1.0 - std::pow(kNeckRadius / kHeadRadius, 2)));
  for (double a = 0.03; a < neck_from; a += 0.06)
    profile.emplace_back(-kHeadRadius * std::cos(a), kHeadRadius * std::sin(a));
  for (double x = 18.5; x <= neck_length; x += 1.5) profile.emplace_back(x, kNeckRadius);
  TriMesh femur = revolved(profile, 60);
  // the axis of revolution to (-cos, 0, -sin): a turn about y, which keeps the orientation
  Mat3 R;
  R << -std::cos(kNeckTilt), 0, std::sin(kNeckTilt), 0, 1, 0, -std::sin(kNeckTilt), 0,
      -std::cos(kNeckTilt);
  femur.points *= R.transpose();
  return femur;
}

/// The surface of a tetrahedral mesh, its vertices numbered anew.
inline TriMesh surface_of(const TetMesh& tets) {
  std::map<Index, Index> number;
  for (Index f = 0; f < tets.facets.rows(); ++f)
    for (int c = 0; c < 3; ++c)
      number.emplace(tets.facets(f, c), static_cast<Index>(number.size()));
  TriMesh mesh;
  mesh.points.resize(static_cast<Index>(number.size()), 3);
  for (const auto& [old, now] : number) mesh.points.row(now) = tets.points.row(old);
  mesh.triangles = tets.facets.unaryExpr([&](Index v) { return number.at(v); });
  return mesh;
}

inline TetMesh small_socket_cartilage() {
  return cap_shell(kSocketRadius, kSocketRadius - 1.5, kSocketAngle, 10, 1);
}
inline TetMesh small_head_cartilage() {
  return cap_shell(kHeadRadius, kSocketRadius - 1.5, radians(75.0), 12, 1);
}
inline TriMesh small_hip_bone() {
  return surface_of(cap_shell(kSocketRadius + 8.0, kSocketRadius, kSocketAngle, 14, 1));
}

/// Cubic image of `n` voxels about the joint centre: brighter in a ball where the head is.
inline Volume small_image(Index n = 32, double voxel = 4.0) {
  Volume image;
  image.size = {n, n, n};
  image.spacing = Vec3::Constant(voxel);
  image.origin = Vec3::Constant(-0.5 * voxel * (n - 1));
  image.values.resize(static_cast<std::size_t>(image.n_voxels()));
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) {
        const bool inside = image.position(Vec3(i, j, k)).norm() < kHeadRadius;
        image.values[static_cast<std::size_t>(image.offset(i, j, k))] =
            (inside ? 150.0F : 60.0F) + static_cast<float>((7 * i + 3 * j + 5 * k) % 11);
      }
  return image;
}

/// The folder of a run up to `mesh`, as the stages leave it, and what its subject file names.
class SmallRun {
 public:
  explicit SmallRun(const std::string& name)
      : folder_(std::filesystem::temp_directory_path() /
                ("coxa_" + name + "_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(folder_);
    const TetMesh socket = small_socket_cartilage(), head = small_head_cartilage();
    write("femur", small_femur());
    write("hip_bone", small_hip_bone());
    write("femoral_cartilage", surface_of(head));
    write("acetabular_cartilage", surface_of(socket));
    io::write_tets(folder_ / "mesh" / "femoral_cartilage.vtu", head);
    io::write_tets(folder_ / "mesh" / "acetabular_cartilage.vtu", socket);
    for (const char* verb : {"segment", "mesh"}) {
      pipeline::Record record;
      record.verb = verb;
      pipeline::write_record(folder_ / verb / (std::string(verb) + ".json"), record);
    }
    io::write_volume(folder_ / "image.nii.gz", small_image());
    io::write_bytes(folder_ / "subject.toml",
                    "name = \"small\"\nside = \"right\"\n[image]\npath = \"image.nii.gz\"\n"
                    "[motion]\npattern = \"flexion\"\nframes = 2\n");
  }
  ~SmallRun() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  SmallRun(const SmallRun&) = delete;
  SmallRun& operator=(const SmallRun&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  void write(const std::string& structure, const TriMesh& mesh) const {
    io::write_surface(folder_ / "segment" / (structure + ".vtp"), mesh);
  }
  std::filesystem::path folder_;
};

}  // namespace coxa::test
