#include <coxa/io/track_model.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>

#include <nlohmann/json.hpp>

namespace coxa::io {
namespace {

using nlohmann::json;

json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Vec3 read_vector(const json& value, const std::string& file, const std::string& key) {
  const bool good = value.is_array() && value.size() == 3 && value[0].is_number() &&
                    value[1].is_number() && value[2].is_number();
  if (!good) fail(ErrorCode::bad_file, file, ": '", key, "' must be three numbers [x, y, z], mm");
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

const json& member(const json& object, const std::string& file, const std::string& key) {
  if (!object.contains(key)) fail(ErrorCode::bad_file, file, ": the key '", key, "' is missing");
  return object.at(key);
}

std::map<std::string, Vec3> read_markers_of(const json& object, const std::string& file,
                                            const std::string& key) {
  const json& markers = member(object, file, key);
  if (!markers.is_object())
    fail(ErrorCode::bad_file, file, ": '", key, "' must map labels to [x, y, z]");
  std::map<std::string, Vec3> result;
  for (const auto& [label, position] : markers.items())
    result[label] = read_vector(position, file, key + "." + label);
  return result;
}

double read_number(const json& object, const std::string& file, const std::string& key,
                   double otherwise) {
  if (!object.contains(key)) return otherwise;
  if (!object[key].is_number()) fail(ErrorCode::bad_file, file, ": '", key, "' must be a number");
  return object[key].get<double>();
}

Side read_side(const json& object, const std::string& file) {
  if (!object.contains("side")) return Side::right;
  if (object["side"] == "right") return Side::right;
  if (object["side"] == "left") return Side::left;
  fail(ErrorCode::bad_file, file, ": 'side' must be \"right\" or \"left\"");
}

}  // namespace

motion::HipModel read_hip_model(const std::filesystem::path& path) {
  const std::string file = path.string();
  const json object = json::parse(read_bytes(path), nullptr, false);
  if (object.is_discarded() || !object.is_object())
    fail(ErrorCode::bad_file, file, ": not a JSON object");
  motion::HipModel model;
  model.side = read_side(object, file);
  const auto centre = [&](const char* key) {
    return read_vector(member(object, file, key), file, key);
  };
  model.joint_centre_pelvis = centre("joint_centre_pelvis_mm");
  model.joint_centre_femur = centre("joint_centre_femur_mm");
  model.pelvis_markers = read_markers_of(object, file, "pelvis_landmarks_mm");
  model.thigh_markers = read_markers_of(object, file, "thigh_markers_femur_mm");
  model.marker_sd = read_number(object, file, "marker_sd_mm", 0.0);
  model.pelvis_centre_sd = read_number(object, file, "pelvis_centre_sd_mm", 0.0);
  model.femur_centre_sd = read_number(object, file, "femur_centre_sd_mm", 0.0);
  if (object.contains("calibration_frame")) {
    const double frame = read_number(object, file, "calibration_frame", 1.0);
    if (frame < 1)
      fail(ErrorCode::bad_file, file, ": 'calibration_frame' counts from 1, got ", frame);
    model.calibration_frame = static_cast<Index>(frame) - 1;
  }
  if (object.contains("source") && object["source"].is_string())
    model.source = object["source"].get<std::string>();
  return model;
}

void write_hip_model(const std::filesystem::path& path, const motion::HipModel& model) {
  json object;
  object["side"] = model.side == Side::right ? "right" : "left";
  object["joint_centre_pelvis_mm"] = vector_json(model.joint_centre_pelvis);
  object["joint_centre_femur_mm"] = vector_json(model.joint_centre_femur);
  for (const auto& [label, p] : model.pelvis_markers)
    object["pelvis_landmarks_mm"][label] = vector_json(p);
  for (const auto& [label, p] : model.thigh_markers)
    object["thigh_markers_femur_mm"][label] = vector_json(p);
  if (model.calibration_frame) object["calibration_frame"] = *model.calibration_frame + 1;
  object["marker_sd_mm"] = model.marker_sd;
  object["pelvis_centre_sd_mm"] = model.pelvis_centre_sd;
  object["femur_centre_sd_mm"] = model.femur_centre_sd;
  object["source"] = model.source;
  write_bytes(path, object.dump(1) + "\n");
}

}  // namespace coxa::io
