#include "joint_files.h"

#include <coxa/core/error.h>
#include <coxa/geom/rigid_transform.h>
#include <coxa/io/collection.h>
#include <coxa/io/tets.h>

#include <cstdio>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

std::string numbered(const std::string& stem, Index frame) {
  std::string digits = std::to_string(frame);
  return stem + "_" + std::string(4 - std::min<std::size_t>(4, digits.size()), '0') + digits +
         ".vtu";
}

/// Symmetric tensors as 3×3 rows, which ParaView knows: from xx yy zz xy yz zx.
MatX full_tensors(const MatX& six) {
  static constexpr int kPlace[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
  MatX nine(six.rows(), 9);
  for (int c = 0; c < 9; ++c) nine.col(c) = six.col(kPlace[c]);
  return nine;
}

io::TetFields element_fields(const joint::StressFields& fields) {
  io::TetFields out;
  out.at_tets["green_strain"] = full_tensors(fields.green_strain);
  out.at_tets["cauchy_stress_MPa"] = full_tensors(fields.cauchy_stress);
  out.at_tets["principal_stress_MPa"] = fields.principal_stress;
  out.at_tets["principal_strain"] = fields.principal_strain;
  out.at_tets["von_mises_MPa"] = fields.von_mises;
  return out;
}

/// What each node and element of a body bore at most in any frame.
class Maxima {
 public:
  void add(const io::TetFields& frame) {
    take(fields_.at_points["contact_pressure_MPa"], frame.at_points.at("contact_pressure_MPa"));
    take(fields_.at_tets["von_mises_MPa"], frame.at_tets.at("von_mises_MPa"));
    const MatX& strain = frame.at_tets.at("principal_strain");
    take(fields_.at_tets["stretching"], strain.col(0));
    take(fields_.at_tets["compression"], -strain.col(2));
  }
  /// On the undeformed mesh; nothing where no frame was added.
  void write(const fs::path& path, const TetMesh& mesh) const {
    if (!fields_.at_points.empty()) io::write_tets(path, mesh, fields_);
  }

 private:
  static void take(MatX& most, const MatX& value) {
    most = most.size() == 0 ? value : MatX(most.cwiseMax(value));
  }
  io::TetFields fields_;
};
struct BodyMaxima {
  Maxima acetabular, femoral, labrum;
};

void write_frame(const fs::path& folder, const joint::JointModel& model,
                 const joint::FrameResult& frame, BodyMaxima& maxima) {
  io::TetFields acetabular = element_fields(joint::acetabular_fields(model, frame));
  acetabular.at_points["displacement_mm"] = frame.acetabular_displacement;
  acetabular.at_points["contact_pressure_MPa"] = frame.acetabular_pressure;
  acetabular.at_points["gap_mm"] = frame.acetabular_gap;
  TetMesh mesh = model.acetabular_cartilage;
  mesh.points += frame.acetabular_displacement;
  io::write_tets(folder / numbered("acetabular", frame.frame), mesh, acetabular);
  maxima.acetabular.add(acetabular);

  io::TetFields femoral = element_fields(joint::femoral_fields(model, frame));
  femoral.at_points["displacement_mm"] = frame.femoral_displacement;
  femoral.at_points["contact_pressure_MPa"] = frame.femoral_pressure;
  mesh = model.femoral_cartilage;
  mesh.points = transformed(mesh.points, frame.X_II) + frame.femoral_displacement;
  io::write_tets(folder / numbered("femoral", frame.frame), mesh, femoral);
  maxima.femoral.add(femoral);
  if (frame.labrum_displacement.rows() == 0) return;

  io::TetFields labrum = element_fields(joint::labrum_fields(model, frame));
  labrum.at_points["displacement_mm"] = frame.labrum_displacement;
  labrum.at_points["contact_pressure_MPa"] = frame.labrum_pressure;
  mesh = model.labrum_body;
  mesh.points += frame.labrum_displacement;
  io::write_tets(folder / numbered("labrum", frame.frame), mesh, labrum);
  maxima.labrum.add(labrum);
}

/// A comma and the number; an empty cell where it is not one.
std::string cell(double value) {
  if (!(value == value)) return ",";
  char text[32];
  std::snprintf(text, sizeof text, ",%.6g", value);
  return text;
}

/// What only some models have: labrum, bare femur in contact, friction, ligaments.
std::size_t n_optional_cells(const joint::JointResult& result) {
  return (result.has_labrum ? 1 : 0) + (result.has_labrum_body ? 5 : 0) +
         (result.bare_bone == joint::BareBone::both ? 1 : 0) + (result.has_friction ? 2 : 0) +
         result.ligaments.size();
}

std::string optional_cells(const joint::FrameResult& f, const joint::JointResult& result) {
  std::string text;
  if (result.has_labrum) text += cell(f.labrum_clearance);
  if (result.has_labrum_body) {
    text += cell(f.balance.force_on_labrum.norm()) + cell(f.labrum.peak_pressure_p99) +
            cell(f.labrum.contact_area) + cell(f.labrum.strain) + cell(f.labrum.peak_strain_p99);
  }
  if (result.bare_bone == joint::BareBone::both) text += cell(f.balance.force_of_femur.norm());
  if (result.has_friction)
    text += cell(f.balance.friction_force.norm()) + cell(f.balance.friction_moment.norm());
  for (const double tension : f.ligament_tension) text += cell(tension);
  return text;
}

std::string header(const joint::JointResult& result) {
  std::string text =
      "frame,time_s,status,flexion_deg,adduction_deg,internal_rotation_deg,translation_x_mm,"
      "translation_y_mm,"
      "translation_z_mm,bone_clearance_mm,peak_pressure_p99_MPa,peak_pressure_p95_MPa,peak_"
      "pressure_5mm2_MPa,"
      "mean_pressure_MPa,contact_area_mm2,contact_area_percent,centre_of_pressure_x_mm,centre_of_"
      "pressure_y_mm,"
      "centre_of_pressure_z_mm,centre_of_pressure_hour,penetration_mm,contact_force_N,force_on_"
      "bare_bone_N,force_error_"
      "percent,"
      "reaction_error,elastic_energy_Nmm,contact_energy_Nmm,work_Nmm,least_volume_ratio,"
      "force_on_thin_cartilage_N,peak_pressure_p99_thick_MPa";
  for (int h = 0; h < 12; ++h) text += join_text(",strain_", h == 0 ? 12 : h, "_oclock");
  for (const char* region : joint::kRegionNames) text += join_text(",strain_", region);
  if (result.has_labrum) text += ",labrum_clearance_mm";
  if (result.has_labrum_body) {
    text +=
        ",force_on_labrum_N,labrum_pressure_p99_MPa,labrum_contact_area_mm2,labrum_strain,"
        "labrum_strain_p99";
  }
  if (result.bare_bone == joint::BareBone::both) text += ",force_of_bare_femur_N";
  if (result.has_friction) text += ",friction_force_N,friction_moment_Nmm";
  for (const std::string& ligament : result.ligaments) text += ",tension_" + ligament + "_N";
  return text + ",residual,iterations,seconds,reason\n";
}

std::string contact_cells(const joint::FrameResult& f, const joint::JointResult& result) {
  const joint::ContactFigures& c = f.contact;
  std::string text = cell(c.peak_pressure_p99) + cell(c.peak_pressure_p95) +
                     cell(c.peak_pressure_patch) + cell(c.mean_pressure) + cell(c.contact_area) +
                     cell(100.0 * c.contact_share);
  for (int i = 0; i < 3; ++i) text += cell(c.centre_of_pressure[i]);
  text += cell(c.centre_hour) + cell(c.penetration) + cell(f.balance.contact_force.norm()) +
          cell(f.balance.force_on_bone.norm()) + cell(100.0 * f.balance.force_error) +
          cell(f.balance.reaction_error) + cell(f.balance.elastic_energy) +
          cell(f.balance.contact_energy) + cell(f.balance.work) + cell(f.crush.least_volume_ratio) +
          cell(f.thin.force) + cell(f.thin.peak_pressure_p99);
  for (const joint::SectorFigures& sector : f.sectors) text += cell(sector.strain);
  for (const joint::SectorFigures& region : f.regions) text += cell(region.strain);
  return text + optional_cells(f, result) + cell(f.residual) + cell(f.iterations) + cell(f.seconds);
}

/// Cells of a frame without a result: as many commas as `contact_cells` has.
std::string no_contact_cells(const joint::JointResult& result) {
  return std::string(21 + 12 + joint::kRegionNames.size() + n_optional_cells(result) + 3, ',');
}

std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2)
    text.insert(at, "\"");
  return text.empty() ? "" : "\"" + text + "\"";
}

}  // namespace

void write_frames(const fs::path& folder, const joint::JointModel& model,
                  const motion::HipMotion& motion, const joint::JointResult& result) {
  std::vector<io::CollectionEntry> entries;
  BodyMaxima maxima;
  for (const joint::FrameResult& frame : result.frames) {
    if (frame.status != joint::FrameStatus::converged) continue;
    write_frame(folder / "frames", model, frame, maxima);
    const double time = motion.time[static_cast<std::size_t>(frame.frame)];
    for (const char* part : {"acetabular", "femoral"}) {
      entries.push_back({time, std::string(part) + "_cartilage",
                         fs::path("frames") / numbered(part, frame.frame)});
    }
    if (result.has_labrum_body) {
      entries.push_back(
          {time, "acetabular_labrum", fs::path("frames") / numbered("labrum", frame.frame)});
    }
  }
  io::write_collection(folder / "results.pvd", entries);
  maxima.acetabular.write(folder / "maxima_acetabular.vtu", model.acetabular_cartilage);
  maxima.femoral.write(folder / "maxima_femoral.vtu", model.femoral_cartilage);
  maxima.labrum.write(folder / "maxima_labrum.vtu", model.labrum_body);
}

std::string summary_csv(const motion::HipMotion& motion, const joint::JointResult& result) {
  std::string text = header(result);
  for (const joint::FrameResult& f : result.frames) {
    text += join_text(f.frame) + cell(motion.time[static_cast<std::size_t>(f.frame)]) + "," +
            joint::name_of(f.status) + cell(degrees(f.angles.flexion)) +
            cell(degrees(f.angles.adduction)) + cell(degrees(f.angles.internal_rotation));
    const bool converged = f.status == joint::FrameStatus::converged;
    for (int i = 0; i < 3; ++i) text += cell(converged ? f.translation[i] : kNaN);
    text += cell(f.bone_clearance) +
            (converged ? contact_cells(f, result) : no_contact_cells(result)) + "," +
            quoted(f.reason) + "\n";
  }
  return text;
}

}  // namespace coxa::pipeline
