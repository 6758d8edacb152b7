#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/measure/morphometry.h>
#include <coxa/pipeline/measure_stage.h>
#include <coxa/pipeline/reference_ranges.h>
#include <coxa/pipeline/subject.h>

#include <cmath>

#include "measured_hip.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

measure::RomModel rom_model(const MeasuredHip& hip, const fs::path& folder) {
  for (const char* name : {"femur", "hip_bone", "femoral_cartilage"})
    require(hip.surfaces.count(name), folder.string(), " lacks ", name,
            ": range of motion needs both bones and the femoral cartilage");
  return {.side = hip.side,
          .hip_bone = hip.surfaces.at("hip_bone").mesh,
          .femur = hip.surfaces.at("femur").mesh,
          .femoral_cartilage = hip.surfaces.at("femoral_cartilage").mesh,
          .head_centre = hip.head.centre,
          .head_radius = hip.head.radius,
          .X_IP = hip.frames.pelvis.X_IB,
          .X_IF = hip.frames.femur.X_IB};
}

std::string ending(const measure::RomResult& result) {
  if (result.blocked) return "bones touch on the way to the start";
  return result.contact ? "bones touch" : "no contact";
}

std::string cell(double value) { return std::isfinite(value) ? join_text(value) : ""; }

/// Hour of the contact on the socket's clock face; NaN without contact or socket.
double hour_of(const measure::RomResult& result, const MeasuredHip& hip) {
  const auto socket = hip.surfaces.find("acetabular_cartilage");
  if (socket == hip.surfaces.end() || !result.place.allFinite()) return kNaN;
  const Mat3& R = hip.frames.pelvis.X_IB.R;
  const Vec3 axis = measure::socket_axis(socket->second.mesh, hip.head.centre);
  const double hour = make_clock_face(hip.head.centre, axis, R.col(1), R.col(0)).hour(result.place);
  return hour < 0.5 ? hour + 12.0 : hour;
}

void add_result(const measure::RomResult& result, double hour, Record& record) {
  record.figures[result.name + "_deg"] = degrees(result.angle);
  record.figures[result.name + "_end"] = ending(result);
  if (!result.place.allFinite()) return;
  record.figures[result.name + "_place_lps_mm"] =
      join_text(result.place.x(), " ", result.place.y(), " ", result.place.z());
  if (std::isfinite(hour)) record.figures[result.name + "_clock_hour"] = hour;
}

std::string row_of(const measure::RomResult& result, double hour, double interval,
                   const std::string& judgement) {
  std::string text =
      join_text(result.name, ',', degrees(result.angle), ',', interval, ',', ending(result), ',',
                degrees(result.pose.flexion), ',', degrees(result.pose.adduction), ',',
                degrees(result.pose.internal_rotation), ',', cell(hour));
  for (int i = 0; i < 3; ++i) text += ',' + cell(result.place[i]);
  return text + ",\"" + judgement + "\"\n";
}

}  // namespace

Record run_rom_stage(const fs::path& run_folder, const measure::RomOptions& options, Reuse reuse,
                     const Monitor& monitor) {
  Record wanted;
  wanted.verb = "rom";
  wanted.options = {{"threshold_mm", options.threshold}, {"step_deg", degrees(options.step)}};
  add_measured_inputs(run_folder, wanted);
  const auto body = [&](const fs::path& partial, Record& record) {
    const MeasuredHip hip = read_measured_hip(run_folder, part_of(monitor, "rom", 0.0, 0.2));
    const auto results =
        measure::range_of_motion(rom_model(hip, run_folder), measure::standard_rom_tests(), options,
                                 part_of(monitor, "rom", 0.2, 1.0));
    const auto ranges = read_reference_ranges(shipped_data("reference_ranges.toml"));
    const double interval =
        degrees(std::hypot(hip.frames.pelvis.interval, hip.frames.femur.interval));
    record.figures["interval_deg"] = interval;
    std::string text =
        "examination,angle_deg,interval_95_deg,end,flexion_deg,adduction_deg,"
        "internal_rotation_deg,clock_hour,x_mm,y_mm,z_mm,judgement\n";
    for (const measure::RomResult& result : results) {
      const double hour = hour_of(result, hip);
      add_result(result, hour, record);
      const auto range = ranges.find(result.name + "_deg");
      const std::string judgement =
          range == ranges.end() ? "" : judged(degrees(result.angle), range->second, interval);
      if (!judgement.empty()) record.figures[result.name + "_deg_judgement"] = judgement;
      text += row_of(result, hour, interval, judgement);
    }
    io::write_bytes(partial / "rom.csv", text);
    record.warnings = hip.frames.warnings;
    for (const std::string& warning : record.warnings) monitor.warn(warning);
  };
  return run_stage(run_folder / "rom", wanted, reuse, monitor, body);
}

}  // namespace coxa::pipeline
