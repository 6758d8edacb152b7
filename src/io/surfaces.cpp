#include <coxa/io/surfaces.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>

#include "surface_formats.h"

#include <charconv>

namespace coxa::io {
namespace {

namespace fs = std::filesystem;

void check_surface(const Surface& surface, const std::string& source) {
  const TriMesh& mesh = surface.mesh;
  if (mesh.empty()) fail(ErrorCode::bad_mesh, source, " holds no triangle");
  if (mesh.triangles.minCoeff() < 0 || mesh.triangles.maxCoeff() >= mesh.n_vertices()) {
    fail(ErrorCode::bad_file, source, ": a triangle names vertex ",
         mesh.triangles.minCoeff() < 0 ? mesh.triangles.minCoeff() : mesh.triangles.maxCoeff(),
         ", there are ", mesh.n_vertices(), " vertices");
  }
  if (!mesh.points.allFinite()) fail(ErrorCode::bad_file, source, ": a vertex is not finite");
}

void check_fields(const Surface& surface, const fs::path& path) {
  for (const auto& [field, values] : surface.fields) {
    require(values.size() == surface.mesh.n_vertices(), "field ", field, " for ", path.string(),
            " has ", values.size(), " values, the surface ", surface.mesh.n_vertices(),
            " vertices");
  }
}

}  // namespace

Surface read_surface_with_fields(const fs::path& path) {
  const std::string extension = extension_of(path);
  const std::string source = path.string();
  require(extension == ".ply" || extension == ".stl" || extension == ".obj" || extension == ".vtp",
          "cannot read a surface from ", source, ": known are .ply, .stl, .obj, .vtp");
  const std::string bytes = read_bytes(path);
  Surface surface;
  if (extension == ".ply") surface = parse_ply(bytes, source);
  if (extension == ".stl") surface.mesh = parse_stl(bytes, source);
  if (extension == ".obj") surface.mesh = parse_obj(bytes, source);
  if (extension == ".vtp") surface = parse_vtp(bytes, source);
  check_surface(surface, source);
  return surface;
}

TriMesh read_surface(const fs::path& path) { return read_surface_with_fields(path).mesh; }

void write_surface(const fs::path& path, const Surface& surface) {
  const std::string extension = extension_of(path);
  check_fields(surface, path);
  if (extension == ".ply") return write_bytes(path, format_ply(surface));
  if (extension == ".stl") return write_bytes(path, format_stl(surface.mesh));
  if (extension == ".obj") return write_bytes(path, format_obj(surface.mesh));
  if (extension == ".vtp") return write_bytes(path, format_vtp(surface));
  require(false, "cannot write a surface to ", path.string(), ": known are .ply, .stl, .obj, .vtp");
}

void write_surface(const fs::path& path, const TriMesh& mesh) {
  write_surface(path, Surface{mesh, {}});
}

std::optional<Index> read_bone_side_faces(const fs::path& path) {
  static constexpr std::string_view kKey = "bone_side_faces ";
  for (const std::string& comment : ply_comments(read_bytes(path))) {
    if (!comment.starts_with(kKey)) continue;
    Index n = 0;
    const char* end = comment.data() + comment.size();
    if (std::from_chars(comment.data() + kKey.size(), end, n).ec == std::errc() && n >= 0) return n;
    fail(ErrorCode::bad_file, path.string(), ": comment '", comment, "' does not name a number");
  }
  return std::nullopt;
}

void TriangleList::add_polygon(const std::vector<Index>& corners) {
  for (std::size_t c = 2; c < corners.size(); ++c) {
    flat_.insert(flat_.end(), {corners[0], corners[c - 1], corners[c]});
  }
}

Triangles TriangleList::triangles() const {
  return Eigen::Map<const Triangles>(flat_.data(), static_cast<Eigen::Index>(flat_.size() / 3), 3);
}

Points points_from(const std::vector<double>& flat) {
  return Eigen::Map<const Points>(flat.data(), static_cast<Eigen::Index>(flat.size() / 3), 3);
}

}  // namespace coxa::io
