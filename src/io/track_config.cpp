#include <coxa/io/track_config.h>

#include <coxa/core/error.h>
#include <coxa/io/config.h>
#include <coxa/io/files.h>
#include <coxa/io/track_model.h>

namespace coxa::io {
namespace {

using motion::CentreSource;

Side read_side(const Table& table, Side otherwise) {
  const auto side = table.find<std::string>("side");
  if (!side) return otherwise;
  require(*side == "left" || *side == "right", table.where("side"), " must be left or right, got '",
          *side, "'");
  return *side == "left" ? Side::left : Side::right;
}

// frames are counted from 1 in files, from 0 inside; a last frame is the end of a half-open range
Index read_first_frame(const Table& table, const std::string& key, Index otherwise) {
  const auto frame = table.find<Index>(key);
  if (!frame) return otherwise;
  require(*frame >= 1, table.where(key), " counts from 1, got ", *frame);
  return *frame - 1;
}

std::map<std::string, Vec3> read_positions(const Table& table) {
  std::map<std::string, Vec3> positions;
  for (const std::string& label : table.keys()) positions[label] = table.get<Vec3>(label);
  return positions;
}

std::optional<CentreSource> read_centre_source(const Table& table) {
  const auto text = table.find<std::string>("joint_centre");
  if (!text) return std::nullopt;
  if (*text == "surfaces") return CentreSource::surfaces;
  if (*text == "harrington") return CentreSource::harrington;
  if (*text == "bell") return CentreSource::bell;
  if (*text == "score") return CentreSource::score;
  require(*text == "functional_sphere", table.where("joint_centre"),
          " must be surfaces, harrington, bell, score or functional_sphere, got '", *text, "'");
  return CentreSource::functional_sphere;
}

motion::MarkerMap read_marker_map(const Table& table, Side side) {
  motion::MarkerMap map = motion::default_marker_map(side);
  for (const motion::MarkerRole role : motion::kAllMarkerRoles) {
    if (const auto labels = table.find<std::vector<std::string>>(std::string(name(role))))
      map[role] = *labels;
  }
  table.finish();
  return map;
}

void read_calibration(const Table& table, TrackConfig& config) {
  motion::CalibrationOptions& options = config.setup.calibration;
  config.neutral_trial = table.find_path("trial");
  options.first_frame = read_first_frame(table, "first_frame", 0);
  options.end_frame = table.find<Index>("last_frame");
  options.centre = read_centre_source(table);
  options.joint_centre_pelvis = table.find<Vec3>("joint_centre_pelvis_mm");
  options.joint_centre_sd = table.value_or("joint_centre_sd_mm", options.joint_centre_sd);
  options.knee_half_width = table.value_or("knee_half_width_mm", options.knee_half_width);
  options.marker_sd = table.value_or("marker_sd_mm", options.marker_sd);
  table.finish();
}

// a model written into the configuration itself: [model] with the centres, [model.pelvis_markers],
// [model.thigh_markers]
motion::HipModel read_model_table(const Table& table, Side side) {
  motion::HipModel model;
  model.side = side;
  model.joint_centre_pelvis = table.get<Vec3>("joint_centre_pelvis_mm");
  model.joint_centre_femur = table.get<Vec3>("joint_centre_femur_mm");
  model.marker_sd = table.value_or("marker_sd_mm", 0.0);
  model.pelvis_centre_sd = table.value_or("pelvis_centre_sd_mm", 0.0);
  model.femur_centre_sd = table.value_or("femur_centre_sd_mm", 0.0);
  model.source = table.value_or<std::string>("source", "");
  if (table.has("calibration_frame"))
    model.calibration_frame = read_first_frame(table, "calibration_frame", 0);
  const auto pelvis = table.find_table("pelvis_markers"), thigh = table.find_table("thigh_markers");
  require(pelvis && thigh, table.where("pelvis_markers"),
          ": [model] needs the tables pelvis_markers and thigh_markers");
  model.pelvis_markers = read_positions(*pelvis);
  model.thigh_markers = read_positions(*thigh);
  table.finish();
  return model;
}

void read_cleaning(const Table& table, motion::CleaningOptions& cleaning) {
  cleaning.longest_gap = table.value_or("longest_gap_s", cleaning.longest_gap);
  cleaning.longest_curve = table.value_or("longest_curve_s", cleaning.longest_curve);
  cleaning.jump = table.value_or("jump_mm", cleaning.jump);
  cleaning.cutoff_hz = table.value_or("cutoff_hz", cleaning.cutoff_hz);
  table.finish();
}

void read_errors(const Table& table, motion::TrackOptions& options) {
  options.measurement_sd = table.value_or("measurement_sd_mm", options.measurement_sd);
  options.joint_translation_sd =
      table.value_or("joint_translation_sd_mm", options.joint_translation_sd);
  options.common_rotation_share =
      table.value_or("common_rotation_share", options.common_rotation_share);
  table.finish();
}

}  // namespace

TrackConfig read_track_config(const std::filesystem::path& path) {
  TrackConfig config;
  motion::TrackSetup& setup = config.setup;
  if (extension_of(path) == ".json") {
    setup.model = read_hip_model(path);
    setup.side = setup.model->side;
    return config;
  }
  const Table table = Table::read(path);
  if (const auto file = table.find_path("model_file")) {
    setup.model = read_hip_model(*file);
    setup.side = setup.model->side;
  }
  setup.side = read_side(table, setup.side);
  if (const auto model = table.find_table("model"))
    setup.model = read_model_table(*model, setup.side);
  require(!setup.model || setup.model->side == setup.side, table.where("side"),
          " differs from the model's side");
  if (const auto method = table.find<std::string>("method"))
    setup.track.method = motion::pose_method(*method);
  setup.first_frame = read_first_frame(table, "first_frame", 0);
  setup.end_frame = table.find<Index>("last_frame");
  if (const auto labels = table.find_table("labels")) {
    for (const std::string& label : labels->keys())
      setup.rename[label] = labels->get<std::string>(label);
  }
  if (const auto calibration = table.find_table("calibration"))
    read_calibration(*calibration, config);
  if (const auto map = table.find_table("marker_map"))
    setup.calibration.map = read_marker_map(*map, setup.side);
  if (const auto cleaning = table.find_table("cleaning")) read_cleaning(*cleaning, setup.cleaning);
  if (const auto errors = table.find_table("errors")) read_errors(*errors, setup.track);
  table.finish();
  return config;
}

}  // namespace coxa::io
