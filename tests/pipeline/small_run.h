#pragma once

#include <coxa/io/files.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/tets.h>
#include <coxa/io/volumes.h>
#include <coxa/pipeline/record.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "support/small_hip.h"

namespace coxa::test {

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
      record.options["side"] = std::string("right");
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
