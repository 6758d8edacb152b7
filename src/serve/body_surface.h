#pragma once

#include <coxa/joint/joint_result.h>
#include <coxa/mesh/tet_mesh.h>

#include <array>
#include <map>
#include <string>
#include <vector>

namespace coxa::serve {

/// A value that cartilage can be coloured by.
struct FieldName {
  const char* key;
  const char* label;  ///< for people
  const char* unit;   ///< empty for strains
};
inline constexpr std::array<FieldName, 9> kFrameFields = {{
    {"contact_pressure", "contact pressure", "MPa"},
    {"effective_strain", "effective strain", ""},
    {"von_mises", "von Mises stress", "MPa"},
    {"first_principal_stress", "first principal stress", "MPa"},
    {"third_principal_stress", "third principal stress", "MPa"},
    {"maximum_shear", "maximum shear stress", "MPa"},
    {"first_principal_strain", "first principal strain", ""},
    {"third_principal_strain", "third principal strain", ""},
    {"gap", "gap", "mm"},
}};

/// The boundary of a tetrahedral cartilage: all that the browser draws.
struct BodySurface {
  std::vector<Index> node_of;      ///< mesh node of every surface vertex
  Triangles triangles;             ///< of surface vertices
  std::vector<std::uint8_t> tags;  ///< FacetTag of every triangle
};
BodySurface body_surface(const TetMesh& mesh);

/// One of the two cartilages as meshed, and its boundary.
struct Body {
  std::string name;  ///< acetabular, femoral
  TetMesh mesh;
  BodySurface surface;
};

/// Rows of a per-node matrix at the surface's vertices.
MatX at_surface(const BodySurface& surface, const MatX& per_node);

/// Means of element values around every node, of plain weight.
VecX node_means(const TetMesh& mesh, const VecX& per_tet);

/// Distance of every surface vertex to the other face: articular vertices to the bone side, all
/// others to the articular side, mm.
VecX surface_thickness(const TetMesh& mesh, const BodySurface& surface);

/// The element fields of kFrameFields, at nodes.
std::map<std::string, VecX> nodal_fields(const TetMesh& mesh, const joint::StressFields& fields);

}  // namespace coxa::serve
