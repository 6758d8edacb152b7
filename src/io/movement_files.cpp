#include <coxa/io/movement_files.h>

#include <coxa/core/error.h>
#include <coxa/io/config.h>
#include <coxa/io/files.h>

#include <iomanip>
#include <sstream>

namespace coxa::io {
namespace {

using motion::Interpolation;

Interpolation interpolation_of(const Table& table) {
  const auto text = table.value_or<std::string>("interpolation", "smooth");
  if (text == "smooth") return Interpolation::smooth;
  if (text == "linear") return Interpolation::linear;
  require(text == "periodic", table.where("interpolation"),
          " must be smooth, linear or periodic, got '", text, "'");
  return Interpolation::periodic;
}

const char* name_of(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::smooth:
      return "smooth";
    case Interpolation::linear:
      return "linear";
    case Interpolation::periodic:
      return "periodic";
  }
  return "unknown";
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + "\"";
}

}  // namespace

motion::ClinicalPattern read_pattern(const std::filesystem::path& path) {
  const Table table = Table::read(path);
  motion::ClinicalPattern pattern;
  pattern.name = table.get<std::string>("name");
  pattern.description = table.value_or<std::string>("description", "");
  pattern.source = table.value_or<std::string>("source", "");
  pattern.interpolation = interpolation_of(table);
  const auto time = table.get<std::vector<double>>("time_s");
  const auto column = [&](const char* key) {
    const auto values = table.get<std::vector<double>>(key);
    require(values.size() == time.size(), table.where(key), " has ", values.size(),
            " values, time_s has ", time.size());
    return values;
  };
  const auto flexion = column("flexion_deg"), adduction = column("adduction_deg"),
             rotation = column("internal_rotation_deg");
  table.finish();
  for (std::size_t k = 0; k < time.size(); ++k) {
    pattern.poses.push_back({.time = time[k],
                             .angles = {.flexion = radians(flexion[k]),
                                        .adduction = radians(adduction[k]),
                                        .internal_rotation = radians(rotation[k])}});
  }
  angles_at(pattern, 0.0);  // checks times and poses
  return pattern;
}

void write_pattern(const std::filesystem::path& path, const motion::ClinicalPattern& pattern) {
  std::ostringstream text;
  text << std::setprecision(8) << "name = " << quoted(pattern.name)
       << "\ndescription = " << quoted(pattern.description)
       << "\nsource = " << quoted(pattern.source) << "\ninterpolation = \""
       << name_of(pattern.interpolation) << "\"\n";
  const auto list = [&](const char* key, const auto& value) {
    text << key << " = [";
    for (std::size_t k = 0; k < pattern.poses.size(); ++k)
      text << (k > 0 ? ", " : "") << value(pattern.poses[k]);
    text << "]\n";
  };
  list("time_s", [](const auto& pose) { return pose.time; });
  list("flexion_deg", [](const auto& pose) { return degrees(pose.angles.flexion); });
  list("adduction_deg", [](const auto& pose) { return degrees(pose.angles.adduction); });
  list("internal_rotation_deg",
       [](const auto& pose) { return degrees(pose.angles.internal_rotation); });
  write_bytes(path, text.str());
}

}  // namespace coxa::io
