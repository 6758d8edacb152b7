#include <coxa/pipeline/mesh_stage.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/tets.h>
#include <coxa/meshing/bone_side.h>
#include <coxa/pipeline/segment_stage.h>

#include "filled_surface.h"
#include "usable_surface.h"

#include <algorithm>
#include <utility>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

// the labrum is a small body beside the cartilages
constexpr int kLabrumTets = 4000;

std::string method_name(meshing::Method method) {
  switch (method) {
    case meshing::Method::automatic:
      return "automatic";
    case meshing::Method::medial:
      return "medial";
    case meshing::Method::lattice:
      return "lattice";
  }
  return "";
}

void add_options(const meshing::MeshingOptions& options, Record& record) {
  record.options = {{"method", method_name(options.method)},
                    {"max_tets", options.max_tets ? Value(std::int64_t{*options.max_tets})
                                                  : Value(std::string("by method"))},
                    {"cell_per_thickness", options.cell_per_thickness},
                    {"rim_rounding_mm", options.rim_rounding},
                    {"nodes_per_element",
                     std::int64_t{options.order == meshing::ElementOrder::ten_node ? 10 : 4}},
                    {"improvement_rounds", std::int64_t{options.improvement_rounds}}};
  if (options.layers) record.options["layers"] = std::int64_t{*options.layers};
}

/// @param body its name before figures and notes; empty where there is but one
void add_figures(const meshing::MeshingResult& result, const std::string& body, Record& record) {
  const std::string prefix = body.empty() ? "" : body + "_";
  const meshing::MeshingReport& report = result.report;
  record.figures[prefix + "tets"] = std::int64_t{result.mesh.n_tets()};
  record.figures[prefix + "method"] = method_name(report.method);
  record.figures[prefix + "layers"] = std::int64_t{report.layers};
  record.figures[prefix + "aspect_mean"] = report.quality.aspect_mean;
  record.figures[prefix + "aspect_p05"] = report.quality.aspect_p05;
  record.figures[prefix + "aspect_min"] = report.quality.aspect_min;
  record.figures[prefix + "dihedral_min_deg"] = degrees(report.quality.dihedral_min);
  record.figures[prefix + "dihedral_max_deg"] = degrees(report.quality.dihedral_max);
  record.figures[prefix + "rim_rounding_mm"] = report.rim_rounding;
  record.figures[prefix + "envelope_max_mm"] = report.envelope;
  if (result.mesh.mid_nodes.rows() > 0)
    record.figures[prefix + "least_jacobian_ratio"] = report.least_jacobian;
  for (const std::string& note : report.notes)
    record.warnings.push_back(body.empty() ? note : body + ": " + note);
}

bool has_sheet_tags(const TetMesh& mesh) {
  return std::find(mesh.facet_tags.begin(), mesh.facet_tags.end(), FacetTag::articular_side) !=
         mesh.facet_tags.end();
}

/// Tells the bone side: of a sheet the nearer face, of any other body what lies on the bone.
void tag_for_bone(TetMesh& mesh, const TriMesh& bone, const std::string& prefix, Record& record) {
  if (has_sheet_tags(mesh)) {
    meshing::update_bone_side(mesh, bone);
  } else if (!(meshing::tag_bone_side(mesh, bone) > 0.0)) {
    record.warnings.push_back(prefix + "no part of the body lies on the bone");
  }
}

/// The labrum as a body for the joint, where it was segmented and can be meshed.
void add_labrum(const fs::path& segment_folder, const TriMesh& hip_bone,
                const meshing::MeshingOptions& options, const fs::path& partial, Record& record,
                const Monitor& monitor) {
  const fs::path labrum = segment_folder / "acetabular_labrum.vtp";
  if (!fs::exists(labrum)) return;
  meshing::MeshingOptions coarse = options;
  coarse.max_tets = std::min(kLabrumTets, options.max_tets.value_or(kLabrumTets));
  coarse.layers.reset();
  try {
    const TriMesh surface =
        usable_surface(io::read_surface(labrum), "acetabular_labrum", record, monitor);
    meshing::MeshingResult result =
        filled_surface(surface, coarse, Faces::any, "acetabular_labrum", record, monitor);
    // its base lies on the bone, none of the faces that a sheet would have
    std::fill(result.mesh.facet_tags.begin(), result.mesh.facet_tags.end(), FacetTag::untagged);
    tag_for_bone(result.mesh, hip_bone, "acetabular_labrum: ", record);
    add_figures(result, "acetabular_labrum", record);
    io::write_tets(partial / "acetabular_labrum.vtu", result.mesh);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    record.warnings.push_back(join_text("acetabular_labrum was not meshed: ", error.what()));
    monitor.warn(record.warnings.back());
  }
}

}  // namespace

Record run_mesh_file(const MeshRequest& request, const fs::path& out, const Monitor& monitor) {
  Record wanted;
  wanted.verb = "mesh";
  add_options(request.options, wanted);
  wanted.inputs["surface"] = io::sha256_of_path(request.surface);
  if (!request.bone.empty()) wanted.inputs["bone"] = io::sha256_of_path(request.bone);
  const std::string name = request.surface.string();
  const auto body = [&](const fs::path& partial, Record& record) {
    const TriMesh surface =
        usable_surface(io::read_surface(request.surface), name, record, monitor);
    if (!record.warnings.empty())
      io::write_surface(partial / (io::stem_of(out) + "_repaired.ply"), surface);
    const bool any = !request.options.layers;  // faces can be told by the bone
    meshing::MeshingResult result = filled_surface(
        surface, request.options, any ? Faces::any : Faces::needed, name, record, monitor);
    if (!request.bone.empty())
      tag_for_bone(result.mesh, io::read_surface(request.bone), "", record);
    add_figures(result, "", record);
    io::write_tets(partial / out.filename(), result.mesh);
  };
  return run_file(out, wanted, monitor, body);
}

Record run_mesh_stage(const fs::path& segment_folder, const meshing::MeshingOptions& options,
                      const fs::path& folder, Reuse reuse, const Monitor& monitor) {
  Record wanted;
  wanted.verb = "mesh";
  add_options(options, wanted);
  wanted.inputs["segment"] = record_key(read_record(segment_folder / "segment.json"));
  const auto body = [&](const fs::path& partial, Record& record) {
    const SurfaceSet surfaces = read_surfaces(segment_folder);
    double done = 0.0;
    for (const auto& [cartilage, bone] :
         {std::pair{"femoral_cartilage", "femur"}, {"acetabular_cartilage", "hip_bone"}}) {
      require(surfaces.count(cartilage) && surfaces.count(bone), segment_folder.string(), " lacks ",
              cartilage, " or ", bone);
      const TriMesh surface =
          usable_surface(surfaces.at(cartilage).mesh, cartilage, record, monitor);
      meshing::MeshingResult result =
          filled_surface(surface, options, Faces::needed, cartilage, record,
                         part_of(monitor, "mesh", done, done + 0.5));
      tag_for_bone(result.mesh, surfaces.at(bone).mesh, std::string(cartilage) + ": ", record);
      add_figures(result, cartilage, record);
      io::write_tets(partial / (std::string(cartilage) + ".vtu"), result.mesh);
      done += 0.5;
    }
    add_labrum(segment_folder, surfaces.at("hip_bone").mesh, options, partial, record, monitor);
  };
  return run_stage(folder, wanted, reuse, monitor, body);
}

}  // namespace coxa::pipeline
