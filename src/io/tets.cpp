#include <coxa/io/tets.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>

#include "tet_formats.h"

#include <Eigen/Geometry>

namespace coxa::io {
namespace {

namespace fs = std::filesystem;

template <class Matrix>
void check_indices(const Matrix& indices, Index n, const std::string& what,
                   const std::string& source) {
  if (indices.size() == 0) return;
  const Index low = indices.minCoeff(), high = indices.maxCoeff();
  if (low < 0 || high >= n) {
    fail(ErrorCode::bad_file, source, ": ", what, " names node ", low < 0 ? low : high,
         ", there are ", n, " nodes");
  }
}

void check_mesh(const TetMesh& mesh, const std::string& source) {
  if (mesh.n_tets() == 0) fail(ErrorCode::bad_mesh, source, " holds no tetrahedron");
  check_indices(mesh.tets, mesh.n_vertices(), "a tetrahedron", source);
  check_indices(mesh.mid_nodes, mesh.n_vertices(), "a tetrahedron", source);
  check_indices(mesh.facets, mesh.n_vertices(), "a facet", source);
  if (!mesh.points.allFinite()) fail(ErrorCode::bad_file, source, ": a node is not finite");
}

/// Programs differ in the order of the corners; here volumes are positive.
void update_orientation(TetMesh& mesh, const std::string& source) {
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    const auto corner = [&](int c) -> Vec3 { return mesh.points.row(mesh.tets(t, c)); };
    const Vec3 a = corner(0);
    if ((corner(1) - a).cross(corner(2) - a).dot(corner(3) - a) >= 0.0) continue;
    if (mesh.mid_nodes.rows() > 0) {
      fail(ErrorCode::bad_mesh, source, ": ten-node tetrahedron ", t, " has a negative volume");
    }
    std::swap(mesh.tets(t, 2), mesh.tets(t, 3));
  }
}

void check_fields(const std::map<std::string, MatX>& fields, Index n, const char* what,
                  const fs::path& path) {
  for (const auto& [name, values] : fields) {
    require(values.rows() == n, "field ", name, " for ", path.string(), " has ", values.rows(),
            " rows, the mesh ", n, " ", what);
  }
}

/// The file beside `path` with another extension.
fs::path sibling(const fs::path& path, const char* extension) {
  return fs::path(path).replace_extension(extension);
}

}  // namespace

TetFile read_tets_with_fields(const fs::path& path) {
  const std::string extension = extension_of(path), source = path.string();
  TetFile file;
  if (extension == ".vtu") {
    file = parse_vtu(read_bytes(path), source);
  } else if (extension == ".msh") {
    file.mesh = parse_gmsh(read_bytes(path), source);
  } else if (extension == ".node" || extension == ".ele") {
    file.mesh =
        parse_tetgen(read_bytes(sibling(path, ".node")), read_bytes(sibling(path, ".ele")), source);
  } else {
    fail(ErrorCode::bad_input, "cannot read tetrahedra from ", source,
         ": known are .vtu, .msh, .node, .ele");
  }
  check_mesh(file.mesh, source);
  update_orientation(file.mesh, source);
  return file;
}

TetMesh read_tets(const fs::path& path) { return read_tets_with_fields(path).mesh; }

void write_tets(const fs::path& path, const TetMesh& mesh, const TetFields& fields) {
  const std::string extension = extension_of(path);
  check_fields(fields.at_points, mesh.n_vertices(), "vertices", path);
  check_fields(fields.at_tets, mesh.n_tets(), "tetrahedra", path);
  COXA_ASSERT(mesh.facet_tags.size() == static_cast<std::size_t>(mesh.facets.rows()));
  if (extension == ".vtu") return write_bytes(path, format_vtu(mesh, fields));
  require(fields.at_points.empty() && fields.at_tets.empty(),
          "fields can be written to .vtu only, not to ", path.string());
  if (extension == ".msh") return write_bytes(path, format_gmsh(mesh));
  if (extension == ".inp") return write_bytes(path, format_abaqus(mesh));
  if (extension == ".feb") return write_bytes(path, format_febio(mesh));
  if (extension == ".node" || extension == ".ele") {
    require(mesh.mid_nodes.rows() == 0,
            "ten-node tetrahedra are not written in TetGen's format: ", path.string());
    write_bytes(sibling(path, ".node"), format_tetgen_nodes(mesh));
    return write_bytes(sibling(path, ".ele"), format_tetgen_elements(mesh));
  }
  fail(ErrorCode::bad_input, "cannot write tetrahedra to ", path.string(),
       ": known are .vtu, .msh, .node, .ele, .inp, .feb");
}

const char* tag_name(FacetTag tag) {
  switch (tag) {
    case FacetTag::untagged:
      return "untagged";
    case FacetTag::bone_side:
      return "bone_side";
    case FacetTag::articular_side:
      return "articular_side";
    case FacetTag::rim:
      return "rim";
  }
  return "";
}

}  // namespace coxa::io
