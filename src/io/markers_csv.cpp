#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/markers.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "delimited_text.h"

namespace coxa::io {

motion::MarkerData read_markers_csv(const std::filesystem::path& path) {
  const CsvTable table = read_csv(path);
  const std::size_t time = table.column("time_s");
  motion::MarkerData markers;
  const std::string ending = "_x_mm";
  for (const std::string& column : table.columns) {
    if (column.size() <= ending.size() || !column.ends_with(ending)) continue;
    const std::string label = column.substr(0, column.size() - ending.size());
    const std::size_t columns[3] = {table.column(column), table.column(label + "_y_mm"),
                                    table.column(label + "_z_mm")};
    Points trajectory(static_cast<Eigen::Index>(table.rows.size()), 3);
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      for (int k = 0; k < 3; ++k) {
        const bool empty = table.rows[row][columns[k]].empty();
        trajectory(static_cast<Eigen::Index>(row), k) =
            empty ? kNaN : table.number(row, columns[k]);
      }
    }
    markers.labels.push_back(label);
    markers.trajectories.push_back(std::move(trajectory));
  }
  if (markers.labels.empty()) {
    fail(ErrorCode::bad_file, path.string(),
         ": no marker columns (NAME_x_mm, NAME_y_mm, NAME_z_mm)");
  }
  if (table.rows.size() < 2)
    fail(ErrorCode::bad_file, path.string(), ": at least two frames are needed to know the rate");
  markers.first_time = table.number(0, time);
  const double last = table.number(table.rows.size() - 1, time);
  if (!(last > markers.first_time))
    fail(ErrorCode::bad_file, path.string(), ": time_s does not increase");
  markers.rate = static_cast<double>(table.rows.size() - 1) / (last - markers.first_time);
  return markers;
}

void write_markers_csv(const std::filesystem::path& path, const motion::MarkerData& markers) {
  std::ostringstream text;
  text << std::setprecision(10) << "time_s";
  for (const std::string& label : markers.labels) {
    for (const char* axis : {"_x_mm", "_y_mm", "_z_mm"}) text << "," << label << axis;
  }
  text << "\n";
  for (Index frame = 0; frame < markers.n_frames(); ++frame) {
    text << markers.time(frame);
    for (const Points& trajectory : markers.trajectories) {
      for (int k = 0; k < 3; ++k) {
        text << ",";
        if (motion::seen(trajectory, frame)) text << trajectory(frame, k);
      }
    }
    text << "\n";
  }
  write_bytes(path, text.str());
}

motion::MarkerData read_markers(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".c3d") return read_c3d(path);
  if (extension == ".trc") return read_trc(path);
  if (extension == ".csv") return read_markers_csv(path);
  fail(ErrorCode::bad_file, path.string(), ": markers are read from .c3d, .trc or .csv, not from '",
       extension, "'");
}

}  // namespace coxa::io
