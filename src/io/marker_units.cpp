#include "marker_units.h"

#include <coxa/core/error.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

namespace coxa::io {
namespace {

double largest_coordinate(const motion::MarkerData& markers) {
  double largest = 0.0;
  for (const Points& trajectory : markers.trajectories) {
    for (const double x : trajectory.reshaped()) {
      if (std::isfinite(x)) largest = std::max(largest, std::abs(x));
    }
  }
  return largest;
}

}  // namespace

void convert_to_mm(motion::MarkerData& markers, const std::string& unit, const std::string& file) {
  static const std::map<std::string, double> kMillimetres = {
      {"mm", 1.0},  {"cm", 10.0},       {"dm", 100.0},       {"m", 1000.0},
      {"in", 25.4}, {"meters", 1000.0}, {"millimeters", 1.0}};
  std::string name;
  for (const unsigned char c : unit) {
    if (!std::isspace(c)) name += static_cast<char>(std::tolower(c));
  }
  if (name.empty()) {
    // a laboratory is larger than 20 mm and smaller than 20 m
    name = largest_coordinate(markers) < 20.0 ? "m" : "mm";
    markers.warnings.push_back("the file names no unit; its size says " + name);
  }
  const auto it = kMillimetres.find(name);
  if (it == kMillimetres.end()) {
    fail(ErrorCode::bad_file, file, ": the unit '", unit,
         "' is not a length coxa knows (mm, cm, dm, m, in)");
  }
  for (Points& trajectory : markers.trajectories) trajectory *= it->second;
}

}  // namespace coxa::io
