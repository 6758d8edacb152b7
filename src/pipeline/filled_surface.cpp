#include "filled_surface.h"

#include <coxa/core/error.h>
#include <coxa/mesh/rebuild.h>
#include <coxa/mesh/remesh.h>
#include <coxa/mesh/surface_distance.h>
#include <coxa/mesh/unfold.h>

#include <optional>
#include <utility>

namespace coxa::pipeline {
namespace {

// edge lengths, mm, tried when a surface as it is cannot be filled: even triangles about half as
// long as cartilage is thick, longer ones where that fails, since they even out a ragged rim
constexpr double kRemeshEdges[] = {0.7, 1.0, 1.4};
constexpr double kReplacementSpacing = 0.3;  // mm: a fraction of cartilage's thickness
// what is thinner than twice this cannot be filled well and bears nothing, mm
constexpr double kRimRadius = 0.25;
// evens ragged rims and moves a wall of one millimetre by a hundredth, mm
constexpr double kRimSmoothing = 0.3;

/// A surface in place of one that could not be filled; throws where it cannot be made.
TriMesh replacement(const TriMesh& surface, double edge, bool anew) {
  TriMesh even = anew ? rebuild(surface, {.spacing = kReplacementSpacing,
                                          .opening = kRimRadius,
                                          .smoothing = kRimSmoothing,
                                          .target_edge = edge})
                            .mesh
                      : remesh(surface, {.target_edge = edge});
  if (!update_unfolded(even)) fail(ErrorCode::bad_mesh, "the surface still cuts itself");
  return even;
}

/// A sheet filled with its triangles made even, or else made anew; nullopt where neither helps.
std::optional<meshing::MeshingResult> filled_otherwise(const TriMesh& surface,
                                                       const meshing::MeshingOptions& options,
                                                       const std::string& name,
                                                       const std::string& why, Record& record,
                                                       const Monitor& monitor) {
  for (const bool anew : {false, true}) {
    for (const double edge : kRemeshEdges) {
      try {
        const TriMesh even = replacement(surface, edge, anew);
        meshing::MeshingResult result = meshing::mesh_surface(even, options, monitor);
        const SurfaceDistance moved = surface_distance(even, surface);
        record.warnings.push_back(join_text(
            name, anew ? ": the surface was made anew (" : ": its triangles were made even (", edge,
            " mm), which moved it by ", moved.assd, " mm on average and ", moved.hd,
            " mm at most, since ", why));
        monitor.warn(record.warnings.back());
        return result;
      } catch (const Error& error) {
        if (error.code() == ErrorCode::cancelled) throw;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

meshing::MeshingResult filled_surface(const TriMesh& surface,
                                      const meshing::MeshingOptions& options, Faces faces,
                                      const std::string& name, Record& record,
                                      const Monitor& monitor) {
  std::string why;
  std::optional<meshing::MeshingResult> result;
  try {
    result = meshing::mesh_surface(surface, options, monitor);
    if (faces == Faces::any || !result->report.medial_failed) return std::move(*result);
    why = result->report.notes.front();
  } catch (const Error& error) {
    const bool may_help =
        error.code() == ErrorCode::below_quality || error.code() == ErrorCode::bad_mesh;
    if (!may_help || options.method == meshing::Method::lattice) throw;
    why = error.what();
  }
  meshing::MeshingOptions as_sheet = options;
  as_sheet.method = meshing::Method::medial;
  if (auto other = filled_otherwise(surface, as_sheet, name, why, record, monitor))
    return std::move(*other);
  if (!result) fail(ErrorCode::below_quality, name, ": ", why);
  return std::move(*result);
}

}  // namespace coxa::pipeline
