#include <coxa/pipeline/measure_stage.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/surfaces.h>
#include <coxa/measure/morphometry.h>
#include <coxa/measure/sectors.h>
#include <coxa/mesh/measures.h>
#include <coxa/pipeline/reference_ranges.h>
#include <coxa/pipeline/subject.h>

#include <algorithm>
#include <cmath>

#include "measured_hip.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

/// One row of morphometry.csv.
struct Measured {
  std::string name;  ///< with its unit
  double value = kNaN;
  double interval = 0.0;  ///< half-width of the 95 % interval that its frame's axes cause
  std::string frame;      ///< where the frame came from; empty: it needs none
};

/// A third of the vertex's triangles' areas, mm².
VecX vertex_areas(const TriMesh& mesh) {
  const VecX areas = triangle_areas(mesh);
  VecX shares = VecX::Zero(mesh.n_vertices());
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    for (int c = 0; c < 3; ++c) shares[mesh.triangles(t, c)] += areas[t] / 3.0;
  return shares;
}

std::vector<Measured> measured_angles(const measure::Morphometry& m, const MeasuredHip& hip) {
  const motion::BoneFrame &pelvis = hip.frames.pelvis, &femur = hip.frames.femur;
  const double of_pelvis = degrees(pelvis.interval), of_femur = degrees(femur.interval);
  return {
      {"head_radius_mm", m.head_radius, hip.head.interval, ""},
      {"head_roundness_rms_mm", m.head_rms, 0.0, ""},
      {"neck_shaft_angle_deg", degrees(m.neck_shaft_angle), 0.0, ""},
      {"femoral_version_deg", degrees(m.femoral_version), of_femur, femur.source},
      {"alpha_angle_anterior_deg", degrees(m.alpha_angle[3]), 0.0, ""},
      {"largest_alpha_angle_deg", degrees(m.largest_alpha_angle), 0.0, ""},
      {"lateral_centre_edge_angle_deg", degrees(m.lateral_centre_edge_angle), of_pelvis,
       pelvis.source},
      {"acetabular_inclination_deg", degrees(m.acetabular_inclination), of_pelvis, pelvis.source},
      {"acetabular_version_deg", degrees(m.acetabular_version), of_pelvis, pelvis.source}};
}

std::string cell(double value) { return std::isfinite(value) ? join_text(value) : ""; }

void write_morphometry(const fs::path& folder, const std::vector<Measured>& rows, Record& record) {
  const auto ranges = read_reference_ranges(shipped_data("reference_ranges.toml"));
  std::string text =
      "measure,value,interval_95,frame,reference_low,reference_high,judgement,source\n";
  for (const Measured& row : rows) {
    record.figures[row.name] = row.value;
    const auto range = ranges.find(row.name);
    const bool known = range != ranges.end();
    const std::string judgement = known ? judged(row.value, range->second, row.interval) : "";
    if (!judgement.empty()) record.figures[row.name + "_judgement"] = judgement;
    if (row.interval > 0.0 && std::isfinite(row.value))
      record.figures[row.name + "_interval"] = row.interval;
    text +=
        join_text(row.name, ',', cell(row.value), ',', cell(row.interval), ",\"", row.frame, "\",",
                  known ? cell(range->second.low) : "", ',', known ? cell(range->second.high) : "",
                  ",\"", judgement, "\",\"", known ? range->second.source : "", "\"\n");
  }
  io::write_bytes(folder / "morphometry.csv", text);
}

void add_alpha_by_hour(const measure::Morphometry& m, Record& record) {
  for (std::size_t h = 0; h < 12; ++h)
    record.figures[join_text("alpha_angle_", h == 0 ? 12 : h, "_oclock_deg")] =
        degrees(m.alpha_angle[h]);
  record.figures["largest_alpha_angle_hour"] =
      std::int64_t{m.largest_alpha_hour == 0 ? 12 : m.largest_alpha_hour};
}

/// Thickness over one bone, as a surface with the field, figures and rows of thickness.csv.
std::string write_thickness(const fs::path& folder, const MeasuredHip& hip, const ClockFace& clock,
                            const std::string& bone, const std::string& cartilage,
                            const measure::ThicknessOptions& options, Record& record) {
  if (!hip.surfaces.count(bone) || !hip.surfaces.count(cartilage)) return "";
  Surface surface = hip.surfaces.at(bone);
  const TriMesh& layer = hip.surfaces.at(cartilage).mesh;
  const VecX thickness = measure::closed_cartilage_thickness(surface.mesh, layer, options);
  const VecX areas = vertex_areas(surface.mesh);
  surface.fields["cartilage_thickness_mm"] = thickness;
  io::write_surface(folder / (bone + ".vtp"), surface);

  std::vector<double> covered;
  double area_sum = 0.0, sum = 0.0;
  for (Index v = 0; v < thickness.size(); ++v) {
    if (std::isnan(thickness[v])) continue;
    covered.push_back(thickness[v]);
    area_sum += areas[v];
    sum += areas[v] * thickness[v];
  }
  const VecX values = Eigen::Map<const VecX>(covered.data(), static_cast<Index>(covered.size()));
  record.figures[cartilage + "_covered_area_mm2"] = area_sum;
  record.figures[cartilage + "_volume_mm3"] = volume(layer);
  record.figures[cartilage + "_thickness_mean_mm"] = area_sum > 0.0 ? sum / area_sum : kNaN;
  record.figures[cartilage + "_thickness_p05_mm"] = percentile(values, 0.05);
  record.figures[cartilage + "_thickness_median_mm"] = percentile(values, 0.5);
  record.figures[cartilage + "_thickness_p95_mm"] = percentile(values, 0.95);
  std::string rows;
  const auto sectors = measure::sector_statistics(clock, surface.mesh.points, thickness, areas);
  for (std::size_t h = 0; h < 12; ++h) {
    rows += join_text(cartilage, ',', h == 0 ? 12 : h, ',', sectors[h].count, ',',
                      cell(sectors[h].mean), ',', cell(sectors[h].low), ',', cell(sectors[h].high),
                      '\n');
  }
  return rows;
}

/// The socket's clock face, or one from the frames where there is no socket.
ClockFace clock_of(const measure::Morphometry& m, const MeasuredHip& hip) {
  if (hip.surfaces.count("acetabular_cartilage")) return m.socket;
  const Mat3& R = hip.frames.pelvis.X_IB.R;
  const Vec3 lateral = hip.side == Side::right ? Vec3(R.col(2)) : Vec3(-R.col(2));
  return make_clock_face(hip.head.centre, lateral, R.col(1), R.col(0));
}

}  // namespace

Record run_measure_stage(const fs::path& run_folder, const measure::ThicknessOptions& options,
                         Reuse reuse, const Monitor& monitor) {
  Record wanted;
  wanted.verb = "measure";
  wanted.options = {{"max_thickness_mm", options.max_thickness},
                    {"ray_offset_mm", options.ray_offset}};
  add_measured_inputs(run_folder, wanted);
  const auto body = [&](const fs::path& partial, Record& record) {
    const MeasuredHip hip = read_measured_hip(run_folder, part_of(monitor, "measure", 0.0, 0.5));
    const auto morphometry = measure::hip_morphometry(hip.surfaces, hip.frames, hip.head, hip.side);
    monitor.check_cancelled();
    record.figures["side"] = std::string(hip.side == Side::left ? "left" : "right");
    write_morphometry(partial, measured_angles(morphometry, hip), record);
    if (std::isfinite(morphometry.largest_alpha_angle)) add_alpha_by_hour(morphometry, record);
    const ClockFace clock = clock_of(morphometry, hip);
    monitor.progress("measure", 0.7);
    io::write_bytes(
        partial / "thickness.csv",
        "cartilage,clock_hour,vertices,mean_mm,least_mm,greatest_mm\n" +
            write_thickness(partial, hip, clock, "femur", "femoral_cartilage", options, record) +
            write_thickness(partial, hip, clock, "hip_bone", "acetabular_cartilage", options,
                            record));
    for (const auto* list : {&hip.frames.warnings, &morphometry.notes}) {
      for (const std::string& text : *list) {
        record.warnings.push_back(text);
        monitor.warn(text);
      }
    }
  };
  return run_stage(run_folder / "measure", wanted, reuse, monitor, body);
}

}  // namespace coxa::pipeline
