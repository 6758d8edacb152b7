#pragma once

#include <coxa/core/monitor.h>
#include <coxa/core/types.h>
#include <coxa/mesh/tet_mesh.h>
#include <coxa/mesh/tet_quality.h>
#include <coxa/mesh/tri_mesh.h>

#include <optional>
#include <string>
#include <vector>

namespace coxa::meshing {

/// How the tetrahedra are made.
enum class Method {
  automatic,  ///< medial where the body is a sheet, lattice otherwise
  medial,     ///< medial grid, projected to both faces and extruded
  lattice     ///< body-centred cubic lattice conformed to the surface
};

/// Straight elements, or ten-node elements whose boundary follows the surface.
enum class ElementOrder { four_node, ten_node };

struct MeshingOptions {
  Method method = Method::automatic;
  /// 1 to 8 layers through a sheet, exactly; one, freely improved, if not set
  std::optional<int> layers = std::nullopt;
  /// > 100; the cells are made larger until it holds. If not set: 20 000 for a sheet, 45 000 for
  /// each layer where two or more are asked for with four-node elements, 200 000 for a lattice.
  std::optional<int> max_tets = std::nullopt;
  double cell_per_thickness = 1.0;  ///< edge length over layer thickness, > 0
  double rim_rounding = 0.2;        ///< mm, in [0, 0.25]: how far a knife-edge rim may move inwards
  ElementOrder order = ElementOrder::four_node;
  int improvement_rounds = 8;  ///< >= 0: rounds of flips and smoothing
};

/// What was done and how good it is; the mesh itself is always valid.
struct MeshingReport {
  Method method = Method::automatic;  ///< the one used
  double sheetness = 0.0;             ///< share of the surface that faces its other side, in [0, 1]
  bool medial_failed = false;         ///< a sheet, but its medial grid could not be filled
  int layers = 0;                     ///< through the sheet; 0 for a lattice mesh
  double rim_rounding = 0.0;          ///< mm: largest distance the rim was moved inwards
  double envelope = 0.0;              ///< mm: largest distance found between the surface and the
                                      ///< boundary of the mesh, both ways
  TetQuality quality;                 ///< of the four-corner elements
  /// Of ten-node elements: least Jacobian determinant over that of the element's corners.
  double least_jacobian = 1.0;
  std::vector<std::string> notes;  ///< what the caller should know, in plain words
};

struct MeshingResult {
  TetMesh
      mesh;  ///< facets tagged; the two faces of a sheet as bone_side (first) and articular_side
  MeshingReport report;
};

/// Whether a mesh is as good as is asked of any: aspect ratio at least 0.72 in the mean, 0.50 at
/// the 5th percentile and 0.15 everywhere, dihedral angles of 10 to 165 degrees, envelope within
/// 0.3 mm.
bool meets_limits(const MeshingReport& report);

/// Whether a closed surface bounds a thin body with two faces, which the medial method is for;
/// otherwise says why not.
struct SheetLikeness {
  double sheetness = 0.0;           ///< share of the surface that faces its other side, in [0, 1]
  double relative_thickness = 0.0;  ///< over the width of a face
  bool is_sheet() const { return why_not.empty(); }
  std::string why_not;  ///< empty for a sheet
};
/// @throws Error bad_mesh if the surface is open or not manifold
SheetLikeness sheet_likeness(const TriMesh& surface);

/// Fills a closed surface with tetrahedra.
///
/// `Method::automatic` takes the medial grid for a sheet and the lattice for any other body, and
/// also where the medial grid fails, or, unless layers or a number of elements are asked for, where
/// it misses more limits of quality than the lattice; the notes say why.
///
/// @param surface  closed, manifold, oriented outward, not self-intersecting, mm
/// @throws Error   bad_mesh if the surface cannot be filled, naming the place; bad_input for an
/// option
///                 out of range; below_quality if no valid mesh is found; cancelled
/// @note           deterministic: bit-identical for any number of threads
MeshingResult mesh_surface(const TriMesh& surface, const MeshingOptions& options = {},
                           const Monitor& monitor = {});

}  // namespace coxa::meshing
