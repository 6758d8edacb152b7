#include "subject_edits.h"

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/movement_files.h>
#include <coxa/pipeline/run.h>
#include <coxa/pipeline/segment_stage.h>

#include <algorithm>
#include <cmath>

namespace coxa::serve {
namespace fs = std::filesystem;
namespace {
using Json = nlohmann::json;

// names the atlas and the bone frames know, without the side
constexpr const char* kKnown[] = {"femoral_head_centre",
                                  "femoral_neck_centre",
                                  "greater_trochanter_tip",
                                  "lesser_trochanter_tip",
                                  "femoral_shaft_distal",
                                  "lateral_epicondyle",
                                  "medial_epicondyle",
                                  "asis",
                                  "aiis",
                                  "psis",
                                  "pubic_tubercle",
                                  "ischial_tuberosity",
                                  "acetabular_rim_superior"};
constexpr std::size_t kLongestName = 60, kMostLandmarks = 200, kMostPoses = 100000;
constexpr double kFarthest = 10000.0;  // mm

/// A name that is safe as a file's and in every format: letters, digits, _ and -.
std::string word(const Json& json) {
  const std::string name = json.get<std::string>();
  const bool fine = !name.empty() && name.size() <= kLongestName &&
                    std::all_of(name.begin(), name.end(), [](unsigned char c) {
                      return (c < 128 && std::isalnum(c)) || c == '_' || c == '-';
                    });
  require(fine, "\"", name, "\" is no name: letters, digits, _ and - are, at most ", kLongestName);
  return name;
}

std::string version_of(const fs::path& file) {
  return file.empty() || !fs::exists(file) ? "" : io::sha256_of_path(file);
}

Json stored_points(const fs::path& file, Json known) {
  Json list = Json::array();
  if (!file.empty()) {
    for (const auto& [name, p] : io::read_landmarks(file))
      list.push_back({{"name", name}, {"position_lps_mm", {p.x(), p.y(), p.z()}}});
  }
  return {{"version", version_of(file)}, {"landmarks", list}, {"known", std::move(known)}};
}

std::map<std::string, Vec3> points_in(const Json& wanted) {
  const Json& list = wanted.at("landmarks");
  require(list.is_array() && list.size() <= kMostLandmarks, "landmarks must be a list of at most ",
          kMostLandmarks);
  std::map<std::string, Vec3> points;
  for (const Json& entry : list) {
    const std::string name = word(entry.at("name"));
    const auto p = entry.at("position_lps_mm").get<std::array<double, 3>>();
    const Vec3 place(p[0], p[1], p[2]);
    require(place.allFinite() && place.norm() < kFarthest, name, " has no place in the image");
    require(points.emplace(name, place).second, "the landmark ", name, " comes twice");
  }
  return points;
}

}  // namespace

Json stored_landmarks(const CaseFolder& folder) {
  const CaseInput in = folder.input();
  Json known = Json::array();
  for (const char* name : kKnown) {
    known.push_back(in.side ? std::string(name) + (*in.side == Side::left ? "_left" : "_right")
                            : std::string(name));
  }
  return stored_points(folder.landmarks_file(), std::move(known));
}

std::optional<Json> store_landmarks(const CaseFolder& folder, const Json& wanted) {
  if (wanted.at("version").get<std::string>() != version_of(folder.landmarks_file()))
    return std::nullopt;
  io::write_landmarks(folder.folder() / "landmarks.mrk.json", points_in(wanted));
  return stored_landmarks(folder);
}

Json stored_pins(const CaseFolder& folder) {
  Json known = Json::array();
  for (const char* name : kStructures) known.push_back(name);
  return stored_points(folder.pins_file(), std::move(known));
}

std::optional<Json> store_pins(const CaseFolder& folder, const Json& wanted) {
  if (wanted.at("version").get<std::string>() != version_of(folder.pins_file()))
    return std::nullopt;
  const std::map<std::string, Vec3> pins = points_in(wanted);
  for (const auto& [name, place] : pins) {
    const std::string structure = name.substr(0, name.rfind('-'));
    require(structure != name &&
                std::count(std::begin(kStructures), std::end(kStructures), structure) > 0,
            "a pin is named <structure>-<number>, as femur-1; got ", name);
  }
  const fs::path file = folder.folder() / "pins.mrk.json";
  if (pins.empty()) {
    fs::remove(file);
  } else {
    io::write_landmarks(file, pins);
  }
  return stored_pins(folder);
}

Json store_movement(const CaseFolder& folder, const Json& wanted) {
  motion::ClinicalPattern pattern;
  pattern.name = word(wanted.at("name"));
  pattern.description = "Recorded in the live examination";
  pattern.source = "led by hand; no measurement";
  pattern.interpolation = motion::Interpolation::linear;
  const auto time = wanted.at("time_s").get<std::vector<double>>();
  const auto flexion = wanted.at("flexion_deg").get<std::vector<double>>();
  const auto adduction = wanted.at("adduction_deg").get<std::vector<double>>();
  const auto rotation = wanted.at("internal_rotation_deg").get<std::vector<double>>();
  require(time.size() >= 2 && time.size() <= kMostPoses, "a movement has 2 to ", kMostPoses,
          " poses, this one ", time.size());
  require(flexion.size() == time.size() && adduction.size() == time.size() &&
              rotation.size() == time.size(),
          "a movement needs as many angles as times");
  for (std::size_t i = 0; i < time.size(); ++i) {
    require(i == 0 ? time[0] == 0.0 : time[i] > time[i - 1],
            "the times of a movement begin at 0 and increase");
    pattern.poses.push_back(
        {time[i], {radians(flexion[i]), radians(adduction[i]), radians(rotation[i])}});
  }
  const fs::path file = fs::path("movements") / (pattern.name + ".toml");
  io::write_pattern(folder.folder() / file, pattern);
  return {{"file", file.generic_string()}};
}

std::function<void(const Monitor&)> job_body(
    const CaseFolder& folder, const Json& job,
    const std::function<void(const SurfaceSet&)>& on_found) {
  const std::string name = job.at("job").get<std::string>();
  const CaseInput in = folder.input();
  const fs::path landmarks = folder.landmarks_file(), pins = folder.pins_file(),
                 out = folder.folder();
  require(name == "segment" || name == "run", "there is no job \"", name, "\"");
  require(!in.images.empty(), in.fault);
  if (name == "run") {
    require(in.subject.has_value(), "the whole chain needs a subject.toml with a movement");
    return [subject = *in.subject, landmarks, pins, out, on_found](const Monitor& monitor) mutable {
      if (!landmarks.empty()) subject.landmarks = landmarks;
      subject.pins = pins;
      pipeline::run_subject(subject, out, {.from = std::nullopt, .on_found = on_found}, monitor);
    };
  }
  pipeline::SegmentRequest request;
  request.images = in.images;
  request.landmarks = landmarks;
  request.pins = pins;
  request.options.on_found = on_found;
  request.atlas = in.subject ? in.subject->atlas : pipeline::shipped_data("atlas/hip.coxa-atlas");
  if (in.side) {
    request.side = *in.side;
  } else {
    const std::string side = job.at("side").get<std::string>();
    require(side == "left" || side == "right", "the side must be left or right");
    request.side = side == "left" ? Side::left : Side::right;
  }
  return [request, out](const Monitor& monitor) {
    pipeline::run_segment_stage(request, out / "segment", pipeline::Reuse::if_unchanged, monitor);
  };
}

}  // namespace coxa::serve
