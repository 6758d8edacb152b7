#include <coxa/pipeline/report_stage.h>

#include <coxa/core/error.h>
#include <coxa/io/landmarks.h>
#include <coxa/joint/joint_result.h>
#include <coxa/pipeline/frame_picture.h>
#include <coxa/pipeline/motion_stage.h>
#include <coxa/pipeline/segment_stage.h>
#include <coxa/view/pictures.h>
#include <coxa/view/png.h>
#include <coxa/view/report.h>

#include <cmath>
#include <optional>

#include "result_frames.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

constexpr int kMapFrames = 6;  // as the paper's Figure 7

/// What the report draws on.
struct Sources {
  Record segment, mesh, motion, joint;
  SurfaceSet surfaces;
  MotionArtefacts artefacts;
  ResultFrames frames;
};

Sources read_sources(const Subject& subject, const fs::path& run) {
  Sources s;
  s.segment = read_record(run / "segment" / "segment.json");
  s.mesh = read_record(run / "mesh" / "mesh.json");
  s.motion = read_record(run / "motion" / "motion.json");
  s.joint = read_record(run / "joint" / "joint.json");
  s.surfaces = read_surfaces(run / "segment");
  s.artefacts = read_motion_artefacts(run / "motion", subject.side);
  s.frames = read_result_frames(run / "joint");
  return s;
}

std::string text_of(const Value& value) {
  if (const double* number = std::get_if<double>(&value)) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", *number);
    return text;
  }
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "yes" : "no";
  return std::get<std::string>(value);
}

void add_record(view::ReportWriter& page, const Record& record) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [key, value] : record.figures) rows.push_back({key, text_of(value)});
  page.begin_details(record.verb + ": " + text_of(record.seconds) + " s, all figures and options");
  page.table({"figure", "value"}, rows);
  rows.clear();
  for (const auto& [key, value] : record.options) rows.push_back({key, text_of(value)});
  for (const auto& [key, value] : record.inputs) rows.push_back({key + " (SHA-256)", value});
  page.table({"option or input", "value"}, rows);
  page.end_details();
}

void add_warnings(view::ReportWriter& page, const Sources& s) {
  for (const Record* record : {&s.segment, &s.mesh, &s.motion, &s.joint}) {
    for (const std::string& text : record->warnings)
      page.notice(view::Notice::warning, record->verb + ": " + text);
  }
}

std::string figure(const Record& record, const std::string& key) {
  const auto it = record.figures.find(key);
  return it == record.figures.end() ? "–" : text_of(it->second);
}

/// Which of the six regions is strained most at the last converged frame, as a row of the summary.
std::optional<std::vector<std::string>> highest_region(const ResultFrames& frames) {
  const FrameRow* last = nullptr;
  for (const FrameRow& row : frames.rows) {
    if (row.converged()) last = &row;
  }
  if (last == nullptr) return std::nullopt;
  std::string region;
  double highest = -kInfinity;
  for (const char* name : joint::kRegionNames) {
    const double strain = last->number(std::string("strain_") + name);
    if (strain > highest) highest = strain, region = name;
  }
  return std::vector<std::string>{
      "Strained most at the last converged frame (" + text_of(last->number("flexion_deg")) +
          "° flexion, " + text_of(last->number("internal_rotation_deg")) + "° internal rotation)",
      region + ", mean effective strain " + text_of(highest)};
}

void add_summary(view::ReportWriter& page, const Sources& s) {
  page.heading("Summary");
  std::vector<std::vector<std::string>> rows{
      {"Segmentation quality (0 to 1)", figure(s.segment, "quality")},
      {"Femoral head radius", figure(s.motion, "femoral_head_radius_mm") + " mm"},
      {"Joint centre, spread between definitions",
       figure(s.motion, "joint_centre_spread_mm") + " mm"},
      {"Pelvis frame from", figure(s.motion, "pelvis_frame_source")},
      {"Femur frame from", figure(s.motion, "femur_frame_source")},
      {"Load", figure(s.joint, "load")},
      {"Frames converged",
       figure(s.joint, "frames_converged") + " of " + figure(s.joint, "frames")},
      {"Largest peak contact pressure (99th percentile)",
       figure(s.joint, "largest_peak_pressure_p99_mpa") + " MPa"},
      {"Joint force recovered from pressure, largest error",
       figure(s.joint, "largest_force_error_percent") + " %"}};
  if (s.joint.figures.count("sensitivity_shift_mm")) {
    rows.push_back({"Peak pressure when the joint centre moves by " +
                        figure(s.joint, "sensitivity_shift_mm") + " mm with the pose held",
                    figure(s.joint, "sensitivity_lowest_peak_mpa") + " to " +
                        figure(s.joint, "sensitivity_highest_peak_mpa") + " MPa (at rest " +
                        figure(s.joint, "sensitivity_peak_at_rest_mpa") + ")"});
  }
  if (s.joint.figures.count("bony_limit_flexion_deg")) {
    rows.push_back({"Bones first touch at flexion / adduction / internal rotation",
                    figure(s.joint, "bony_limit_flexion_deg") + " / " +
                        figure(s.joint, "bony_limit_adduction_deg") + " / " +
                        figure(s.joint, "bony_limit_internal_rotation_deg") + " degrees, at " +
                        figure(s.joint, "bony_limit_clock_hour") + " o'clock"});
  }
  if (const auto highest = highest_region(s.frames)) rows.push_back(*highest);
  page.table({"", ""}, rows);
  page.paragraph(
      "Research software, not a medical device. Angles: ISB; flexion +, adduction +, internal "
      "rotation +. "
      "Clock: 12 superior, 3 anterior.");
}

std::string pose_title(const FrameRow& row) {
  return join_text(std::lround(row.number("flexion_deg")), "° flexion, ",
                   std::lround(row.number("internal_rotation_deg")), "° internal rotation");
}

/// Up to six converged frames spread over the movement.
std::vector<const FrameRow*> chosen_frames(const ResultFrames& frames) {
  std::vector<const FrameRow*> converged, chosen;
  for (const FrameRow& row : frames.rows) {
    if (row.converged()) converged.push_back(&row);
  }
  const auto n = static_cast<int>(converged.size());
  const int count = std::min(kMapFrames, n);
  for (int i = 0; i < count; ++i) {
    const int at =
        count > 1 ? static_cast<int>(std::lround(static_cast<double>(i) * (n - 1) / (count - 1)))
                  : 0;
    chosen.push_back(converged[static_cast<std::size_t>(at)]);
  }
  return chosen;
}

void add_maps(view::ReportWriter& page, const Sources& s, const fs::path& folder) {
  page.heading("Acetabular cartilage over the movement");
  std::vector<view::MapFrame> strain, pressure;
  TriMesh articular;
  for (const FrameRow* row : chosen_frames(s.frames)) {
    const ArticularMap map = read_articular_map(s.frames, *row);
    articular = map.surface;
    strain.push_back({pose_title(*row), map.effective_strain});
    pressure.push_back({pose_title(*row), map.pressure});
  }
  const Vec3 eye = s.artefacts.frames.femur.X_IB.p;
  const auto add = [&](const std::vector<view::MapFrame>& frames, const std::string& label,
                       const std::string& file) {
    const view::Image image =
        view::strain_map_panel(articular, eye, frames, view::scale_for(frames, label));
    view::write_png(folder / file, image);
    page.picture(
        image,
        label + " of the acetabular cartilage at " + std::to_string(frames.size()) + " frames",
        label + ", seen from the femoral head");
  };
  add(strain, "effective strain", "strain_map.png");
  add(pressure, "contact pressure (MPa)", "pressure_map.png");
}

VecX column(const ResultFrames& frames, const std::string& name) {
  VecX values(static_cast<Index>(frames.rows.size()));
  for (Index i = 0; i < values.size(); ++i)
    values[i] = frames.rows[static_cast<std::size_t>(i)].number(name);
  return values;
}

void add_curves(view::ReportWriter& page, const ResultFrames& frames,
                const motion::HipMotion& motion) {
  page.heading("Curves");
  const VecX time = column(frames, "time_s");
  const auto plot = [&](const std::string& title, const std::string& unit,
                        const std::vector<std::pair<std::string, std::string>>& columns) {
    view::LinePlot lines{title, "time (s)", unit, {}};
    for (const auto& [label, name] : columns)
      lines.series.push_back({label, time, column(frames, name)});
    page.plot(lines);
  };
  plot("Joint angles", "degrees",
       {{"flexion", "flexion_deg"},
        {"adduction", "adduction_deg"},
        {"internal rotation", "internal_rotation_deg"}});
  if (!motion.interval.empty()) page.plot(angle_plot(motion));
  plot("Contact pressure", "MPa",
       {{"peak (99th percentile)", "peak_pressure_p99_MPa"},
        {"peak (5 mm² patch)", "peak_pressure_5mm2_MPa"},
        {"mean", "mean_pressure_MPa"}});
  plot("Contact area", "mm²", {{"contact area", "contact_area_mm2"}});
  std::vector<std::pair<std::string, std::string>> regions;
  for (const char* name : joint::kRegionNames)
    regions.emplace_back(name, std::string("strain_") + name);
  plot("Mean effective strain by region", "", regions);
}

void add_frame_table(view::ReportWriter& page, const ResultFrames& frames) {
  const std::vector<std::string> columns{"frame",
                                         "status",
                                         "flexion_deg",
                                         "internal_rotation_deg",
                                         "peak_pressure_p99_MPa",
                                         "mean_pressure_MPa",
                                         "contact_area_mm2",
                                         "contact_area_percent",
                                         "centre_of_pressure_hour",
                                         "reason"};
  std::vector<std::vector<std::string>> rows;
  for (const FrameRow& row : frames.rows) {
    std::vector<std::string> cells;
    for (const std::string& name : columns) {
      const double number = row.number(name);
      cells.push_back(number == number ? text_of(number) : row.cell(name));
    }
    rows.push_back(cells);
  }
  page.table(columns, rows, "Frame by frame; all columns are in joint/summary.csv");
}

void add_slices(view::ReportWriter& page, const Subject& subject, const Sources& s,
                const fs::path& folder, const Monitor& monitor) {
  const shape::Landmarks landmarks =
      subject.landmarks.empty() ? shape::Landmarks{} : io::read_landmarks(subject.landmarks);
  const Volume image =
      read_image(subject.images.front(), landmarks, Monitor{{}, {}, monitor.cancel_flag});
  const view::Image slices = view::draw_slices(image, s.surfaces, s.artefacts.frames.femur.X_IB.p);
  view::write_png(folder / "slices.png", slices);
  page.picture(slices, "MR slices through the joint centre with the outlines of the structures");
}

void add_anatomy(view::ReportWriter& page, const Subject& subject, const Sources& s,
                 const fs::path& folder, const Monitor& monitor) {
  page.heading("Anatomy");
  if (!subject.images.empty()) add_slices(page, subject, s, folder, monitor);
  const view::Image surfaces = view::draw_surfaces(s.surfaces);
  view::write_png(folder / "surfaces.png", surfaces);
  page.picture(surfaces, "Surfaces of the bones and cartilages from the front and from behind");
  const view::Image frames = draw_bone_frames(s.surfaces, s.artefacts.frames, subject.side);
  view::write_png(folder / "frames.png", frames);
  page.picture(frames, "Axes of the pelvis (" + s.artefacts.frames.pelvis.source +
                           ") and of the femur (" + s.artefacts.frames.femur.source +
                           ") on these bones, and the way in which each angle counts as positive");
}

}  // namespace

Record run_report_stage(const Subject& subject, const fs::path& run_folder, const fs::path& folder,
                        Reuse reuse, const Monitor& monitor) {
  Record wanted;
  wanted.verb = "report";
  for (const char* stage : {"segment", "mesh", "motion", "joint"}) {
    wanted.inputs[stage] =
        record_key(read_record(run_folder / stage / (std::string(stage) + ".json")));
  }
  const auto body = [&](const fs::path& partial, Record&) {
    const Sources sources = read_sources(subject, run_folder);
    view::ReportWriter page(
        "Hip of " + subject.name,
        std::string(subject.side == Side::left ? "left" : "right") + " side, coxa " + version());
    add_warnings(page, sources);
    add_summary(page, sources);
    add_maps(page, sources, partial);
    monitor.progress("report", 0.5);
    add_curves(page, sources.frames, sources.artefacts.motion);
    add_frame_table(page, sources.frames);
    add_anatomy(page, subject, sources, partial, monitor);
    page.heading("How it was computed");
    for (const Record* record :
         {&sources.segment, &sources.mesh, &sources.motion, &sources.joint}) {
      add_record(page, *record);
    }
    page.write(partial / "report.html");
  };
  return run_stage(folder, wanted, reuse, monitor, body);
}

}  // namespace coxa::pipeline
