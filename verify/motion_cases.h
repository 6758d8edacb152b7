#pragma once
// The cases of coxa_verify_motion, on real bones of ../shared: docs/motion.md section 8.
#include <coxa/io/surfaces.h>
#include <coxa/mesh/surface_set.h>
#include <coxa/mesh/topology.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace coxa::verify {

inline constexpr std::pair<const char*, Side> kSides[] = {{"left", Side::left},
                                                          {"right", Side::right}};

/// Bones and cartilages that a folder holds.
inline SurfaceSet read_hip(const std::filesystem::path& folder) {
  SurfaceSet surfaces;
  for (const char* name : {"femur", "hip_bone", "femoral_cartilage", "acetabular_cartilage"}) {
    const auto path = folder / (std::string(name) + ".ply");
    if (std::filesystem::exists(path)) surfaces[name].mesh = io::read_surface(path);
  }
  return surfaces;
}

/// The triangles whose centre `keep` takes.
template <class Keep>
TriMesh part(const TriMesh& mesh, const Keep& keep) {
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Vec3 p = mesh.points(mesh.triangles.row(t), Eigen::all).colwise().mean();
    if (keep(p)) kept.push_back(t);
  }
  return sub_mesh(mesh, kept).mesh;
}

/// Spread of the definitions, noise, half a head: section 8.3.
void print_centres(const std::filesystem::path& shared);
/// Writes the mean shape of the heads of libhip: data/femoral_head.toml.
void learn_heads(const std::filesystem::path& shared, const std::filesystem::path& out);
/// Frames of cropped bones against whole ones: section 8.4.
void print_frames(const std::filesystem::path& shared, const std::filesystem::path& atlas_file);
/// Bones of a real hip in the true and in the tracked poses of trials (PREFIX.trc,
/// PREFIX_model.json, PREFIX_truth.csv, as sta_simulate.py writes them): section 8.7.
void print_collisions(const std::filesystem::path& shared, const std::vector<std::string>& trials);

}  // namespace coxa::verify
