#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/markers.h>

#include <cmath>
#include <iomanip>
#include <set>
#include <sstream>

#include "delimited_text.h"
#include "marker_units.h"

namespace coxa::io {
namespace {

// marker names stand in every third column from the third on
std::vector<std::string> read_names(const std::vector<std::string>& cells) {
  std::vector<std::string> names;
  for (std::size_t k = 2; k < cells.size(); ++k) {
    if (!cells[k].empty()) names.push_back(cells[k]);
  }
  return names;
}

struct TrcHeader {
  double rate = 0.0;
  std::size_t n_frames = 0, n_markers = 0;
  std::string unit;
};

TrcHeader read_header(const std::vector<std::string>& keys, const std::vector<std::string>& values,
                      const std::string& file) {
  TrcHeader header;
  for (std::size_t k = 0; k < keys.size() && k < values.size(); ++k) {
    const auto as_number = [&] { return parse_number(values[k], file, 3, keys[k]); };
    if (keys[k] == "DataRate") header.rate = as_number();
    if (keys[k] == "NumFrames") header.n_frames = static_cast<std::size_t>(as_number());
    if (keys[k] == "NumMarkers") header.n_markers = static_cast<std::size_t>(as_number());
    if (keys[k] == "Units") header.unit = values[k];
  }
  if (!(header.rate > 0)) fail(ErrorCode::bad_file, file, ": line 3 gives no DataRate above 0");
  return header;
}

Vec3 read_position(const std::vector<std::string>& cells, std::size_t first,
                   const std::string& file, std::size_t line) {
  Vec3 position = Vec3::Constant(kNaN);
  for (std::size_t k = 0; k < 3 && first + k < cells.size(); ++k) {
    if (!cells[first + k].empty())
      position[static_cast<int>(k)] = parse_number(cells[first + k], file, line, "a coordinate");
  }
  const bool missing = !position.allFinite() || position.isZero(0.0);
  return missing ? Vec3::Constant(kNaN).eval() : position;
}

}  // namespace

motion::MarkerData read_trc(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::vector<std::string> lines = read_lines(path);
  if (lines.size() < 6 || lines[0].rfind("PathFileType", 0) != 0) {
    fail(ErrorCode::bad_file, file,
         ": not a TRC file (it must start with PathFileType and have five header lines)");
  }
  const TrcHeader header = read_header(split(lines[1], '\t'), split(lines[2], '\t'), file);
  motion::MarkerData markers;
  markers.rate = header.rate;
  markers.labels = read_names(split(lines[3], '\t'));
  if (markers.labels.empty()) fail(ErrorCode::bad_file, file, ": line 4 names no marker");
  const std::set<std::string> unique(markers.labels.begin(), markers.labels.end());
  if (unique.size() != markers.labels.size())
    fail(ErrorCode::bad_file, file, ": line 4 names a marker twice");
  if (markers.labels.size() != header.n_markers) {
    markers.warnings.push_back(
        join_text("NumMarkers says ", header.n_markers, ", ", markers.labels.size(), " are named"));
  }

  std::vector<std::vector<Vec3>> positions(markers.labels.size());
  for (std::size_t line = 5; line < lines.size(); ++line) {
    const std::vector<std::string> cells = split(lines[line], '\t');
    if (cells.size() < 3 || cells[0].empty()) continue;
    if (positions[0].empty())
      markers.first_time = parse_number(cells[1], file, line + 1, "the time");
    for (std::size_t m = 0; m < positions.size(); ++m) {
      positions[m].push_back(read_position(cells, 2 + 3 * m, file, line + 1));
    }
  }
  if (positions[0].empty()) fail(ErrorCode::bad_file, file, ": no frame follows the header");
  if (positions[0].size() != header.n_frames) {
    markers.warnings.push_back(
        join_text("NumFrames says ", header.n_frames, ", ", positions[0].size(), " are there"));
  }
  for (const auto& rows : positions) {
    Points trajectory(static_cast<Eigen::Index>(rows.size()), 3);
    for (std::size_t k = 0; k < rows.size(); ++k)
      trajectory.row(static_cast<Eigen::Index>(k)) = rows[k];
    markers.trajectories.push_back(std::move(trajectory));
  }
  convert_to_mm(markers, header.unit, file);
  return markers;
}

void write_trc(const std::filesystem::path& path, const motion::MarkerData& markers) {
  std::ostringstream text;
  text << std::setprecision(10);
  text << "PathFileType\t4\t(X/Y/Z)\t" << path.filename().string() << "\n"
       << "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOr"
          "igNumFrames\n"
       << markers.rate << "\t" << markers.rate << "\t" << markers.n_frames() << "\t"
       << markers.n_markers() << "\tmm\t" << markers.rate << "\t1\t" << markers.n_frames()
       << "\nFrame#\tTime";
  for (const std::string& label : markers.labels) text << "\t" << label << "\t\t";
  text << "\n\t";
  for (Index m = 1; m <= markers.n_markers(); ++m) text << "\tX" << m << "\tY" << m << "\tZ" << m;
  text << "\n\n";
  for (Index frame = 0; frame < markers.n_frames(); ++frame) {
    text << frame + 1 << "\t" << markers.time(frame);
    for (const Points& trajectory : markers.trajectories) {
      for (int k = 0; k < 3; ++k) {
        text << "\t";
        if (motion::seen(trajectory, frame)) text << trajectory(frame, k);
      }
    }
    text << "\n";
  }
  write_bytes(path, text.str());
}

}  // namespace coxa::io
