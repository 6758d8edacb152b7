#pragma once

#include <coxa/core/monitor.h>
#include <coxa/core/types.h>
#include <coxa/medial/face_pair.h>
#include <coxa/medial/surface_sides.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::medial {

/// Medial grid of a sheet-like body: nodes in the middle with the radius of the ball that touches
/// both faces, joined to cells whose size follows the thickness.
struct MedialSheet {
  Points nodes;               ///< N×3, mm
  VecX radii;                 ///< N, mm: half the distance between the two feet
  Points first_feet;          ///< N×3: where the ball touches the first face, mm
  Points second_feet;         ///< N×3: where it touches the second face, mm
  Triangles cells;            ///< counter-clockwise seen from the second face
  std::vector<char> rim;      ///< N: 1 on the border of the sheet
  std::vector<char> corners;  ///< N: 1 at the corners of that border
};

struct MedialOptions {
  double cell_per_thickness = 1.33;  ///< edge length of a cell over the local thickness, > 0
  double smallest_cell = 0.0;        ///< mm, >= 0: edge length where the body is thinner
  double largest_cell = 5.0;         ///< mm, > 0: edge length where the body is thicker
  double gradation = 0.35;           ///< growth of the edge length per mm along the sheet, > 0
  double knife_edge_rounding = 0.0;  ///< mm, >= 0: how far a knife edge will be moved inwards;
                                     ///< cells beside it are made small enough for that to blunt it
  double blunt_angle = radians(17);  ///< rad, > 0: the angle wanted there
  double chord_error = 0.05;  ///< mm, > 0: cells are made smaller where a straight edge between
                              ///< feet would leave its face by more; never below half their size
  int max_cells = 6000;       ///< smallest_cell and cell_per_thickness are enlarged to meet it
  int iterations = 12;        ///< rounds of cell refinement and fitting, >= 1
};

/// Fits a medial grid to a closed surface whose two faces are known.
///
/// Starts from the first face, pulls every node to the middle by radial forces (equal distance to
/// both faces), and evens out the cells by smoothing forces, splits, collapses and flips.
///
/// @param surface  closed, oriented outward, mm
/// @param sides    as from `split_sides(surface)`
/// @throws Error   bad_mesh if the first face is not a single manifold sheet; bad_input for an
///                 option out of range; cancelled
/// @note           deterministic; serial
/// Source: Charbonnier et al. (the paper), medial grid with radial and smoothing forces; cells are
/// triangles here so that notches and holes need no cutting.
MedialSheet fit_medial_sheet(const TriMesh& surface, const SurfaceSides& sides,
                             const MedialOptions& options = {}, const Monitor& monitor = {});

/// The same between two faces whose rim may have been trimmed.
MedialSheet fit_medial_sheet(const FacePair& faces, const MedialOptions& options = {},
                             const Monitor& monitor = {});

}  // namespace coxa::medial
