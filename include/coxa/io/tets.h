#pragma once

#include <coxa/mesh/tet_mesh.h>

#include <filesystem>
#include <map>
#include <string>

namespace coxa::io {

/// Values on a tetrahedral mesh: name with unit (for example "von_mises_MPa") -> n×c, c = 1, 3
/// or 9.
struct TetFields {
  std::map<std::string, MatX> at_points;  ///< n = vertices
  std::map<std::string, MatX> at_tets;    ///< n = tetrahedra
};

/// Tetrahedra of a VTU, Gmsh `.msh` (2.2 ASCII) or TetGen `.node`/`.ele` file (by its extension),
/// mm.
///
/// Four- and ten-node elements; other elements of VTU and Gmsh files are passed over, save the
/// facets that `write_tets` put there. Four-node tetrahedra are turned to positive volume.
/// @throws Error bad_file if missing or broken; bad_mesh if there is no tetrahedron
TetMesh read_tets(const std::filesystem::path& path);

struct TetFile {
  TetMesh mesh;
  TetFields fields;  ///< of a VTU; else empty
};
TetFile read_tets_with_fields(const std::filesystem::path& path);

/// Writes `.vtu` (64-bit, with fields), `.msh` (Gmsh 2.2 ASCII, facet tags as physical groups),
/// `.node` with its `.ele` (TetGen), `.inp` (Abaqus and CalculiX: mesh, node sets, surfaces) or
/// `.feb` (FEBio 4: mesh, surfaces).
/// @throws Error bad_input for another extension, fields of another size, or fields for a format
/// that has none;
///         bad_file if it cannot be written
void write_tets(const std::filesystem::path& path, const TetMesh& mesh,
                const TetFields& fields = {});

}  // namespace coxa::io
