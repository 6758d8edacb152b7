#include <coxa/io/motion_files.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "delimited_text.h"

namespace coxa::io {
namespace {

using motion::HipAngles;
using motion::HipMotion;

void write_angles(std::ostream& text, const HipAngles& a) {
  text << "," << degrees(a.flexion) << "," << degrees(a.adduction) << ","
       << degrees(a.internal_rotation);
}

HipAngles read_angles(const CsvTable& table, std::size_t row, const std::string& suffix) {
  const auto value = [&](const char* name) {
    return radians(table.number(row, table.column(name + suffix)));
  };
  return {.flexion = value("flexion"),
          .adduction = value("adduction"),
          .internal_rotation = value("internal_rotation")};
}

Vec3 read_vector(const CsvTable& table, std::size_t row, const char* x, const char* y,
                 const char* z) {
  return {table.number(row, table.column(x)), table.number(row, table.column(y)),
          table.number(row, table.column(z))};
}

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

constexpr const char* kMethodKey = " method: ";
constexpr const char* kWarningKey = " warning: ";

}  // namespace

void write_motion(const std::filesystem::path& path, const HipMotion& motion) {
  const bool in_lab = motion.head_lab.rows() == motion.n_frames();
  const bool with_interval = motion.interval.size() == motion.angles.size();
  std::ostringstream text;
  text << std::setprecision(10) << "#" << kMethodKey << one_line(motion.method) << "\n";
  for (const std::string& warning : motion.warnings)
    text << "#" << kWarningKey << one_line(warning) << "\n";
  text << "frame,time_s,flexion_deg,adduction_deg,internal_rotation_deg,head_x_mm,head_y_mm,head_z_"
          "mm,"
          "translation_anterior_mm,translation_superior_mm,translation_right_mm";
  if (with_interval)
    text << ",flexion_interval_deg,adduction_interval_deg,internal_rotation_interval_deg";
  text << "\n";
  for (std::size_t f = 0; f < motion.time.size(); ++f) {
    const Vec3& offset = motion.X_PF[f].p;
    const Vec3 head = in_lab ? Vec3(motion.head_lab.row(static_cast<Eigen::Index>(f))) : offset;
    text << f + 1 << "," << motion.time[f];
    write_angles(text, motion.angles[f]);
    text << "," << head.x() << "," << head.y() << "," << head.z();
    text << "," << offset.x() << "," << offset.y() << "," << offset.z();
    if (with_interval) write_angles(text, motion.interval[f]);
    text << "\n";
  }
  write_bytes(path, text.str());
}

HipMotion read_motion(const std::filesystem::path& path, Side side) {
  const CsvTable table = read_csv(path);
  const std::size_t time = table.column("time_s");
  const bool with_head = table.has("head_x_mm"), with_offset = table.has("translation_anterior_mm");
  const bool with_interval = table.has("flexion_interval_deg");
  HipMotion motion;
  for (const std::string& comment : table.comments) {
    if (comment.starts_with(kMethodKey))
      motion.method = comment.substr(std::string(kMethodKey).size());
    if (comment.starts_with(kWarningKey))
      motion.warnings.push_back(comment.substr(std::string(kWarningKey).size()));
  }
  if (with_head) motion.head_lab.resize(static_cast<Eigen::Index>(table.rows.size()), 3);
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    motion.time.push_back(table.number(row, time));
    if (row > 0 && !(motion.time[row] > motion.time[row - 1])) {
      fail(ErrorCode::bad_file, path.string(), ": line ", table.lines[row],
           ": time_s does not increase");
    }
    motion.angles.push_back(read_angles(table, row, "_deg"));
    if (with_interval) motion.interval.push_back(read_angles(table, row, "_interval_deg"));
    RigidTransform X_PF{motion::rotation_from_angles(motion.angles.back(), side), Vec3::Zero()};
    if (with_offset) {
      X_PF.p = read_vector(table, row, "translation_anterior_mm", "translation_superior_mm",
                           "translation_right_mm");
    }
    motion.X_PF.push_back(X_PF);
    if (with_head) {
      motion.head_lab.row(static_cast<Eigen::Index>(row)) =
          read_vector(table, row, "head_x_mm", "head_y_mm", "head_z_mm");
    }
  }
  return motion;
}

void write_opensim_motion(const std::filesystem::path& path, const HipMotion& motion, Side side) {
  const char* suffix = side == Side::right ? "_r" : "_l";
  std::ostringstream text;
  text << std::setprecision(10) << "coxa\nversion=1\nnRows=" << motion.time.size()
       << "\nnColumns=4\ninDegrees=yes\nendheader\n"
       << "time\thip_flexion" << suffix << "\thip_adduction" << suffix << "\thip_rotation" << suffix
       << "\n";
  for (std::size_t f = 0; f < motion.time.size(); ++f) {
    const HipAngles& a = motion.angles[f];
    text << motion.time[f] << "\t" << degrees(a.flexion) << "\t" << degrees(a.adduction) << "\t"
         << degrees(a.internal_rotation) << "\n";
  }
  write_bytes(path, text.str());
}

void write_residuals(const std::filesystem::path& path, const motion::TrackResult& result) {
  std::ostringstream text;
  text << std::setprecision(8) << "frame,time_s";
  for (const std::string& label : result.thigh_labels) text << "," << label << "_mm";
  text << "\n";
  for (Eigen::Index f = 0; f < result.residuals.rows(); ++f) {
    text << f + 1 << "," << result.motion.time[static_cast<std::size_t>(f)];
    for (const double r : result.residuals.row(f)) {
      text << ",";
      if (std::isfinite(r)) text << r;
    }
    text << "\n";
  }
  write_bytes(path, text.str());
}

void write_joint_centres(const std::filesystem::path& path,
                         const std::vector<motion::JointCentre>& centres) {
  std::ostringstream text;
  text << "definition,x_mm,y_mm,z_mm,radius_mm,rms_mm,covered_share,interval_mm,region\n";
  for (const motion::JointCentre& c : centres) {
    text << c.definition << ',' << c.centre.x() << ',' << c.centre.y() << ',' << c.centre.z() << ','
         << c.radius << ',' << c.rms << ',' << c.covered_share << ',' << c.interval << ",\""
         << c.region << "\"\n";
  }
  write_bytes(path, text.str());
}

void write_events(const std::filesystem::path& path,
                  const std::vector<motion::MarkerEvent>& events) {
  const auto cell = [](std::string words) {
    for (char& c : words) {
      if (c == ',' || c == '\n' || c == '\r' || c == '"') c = ' ';
    }
    return words;
  };
  std::vector<motion::MarkerEvent> sorted = events;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  std::ostringstream text;
  text << std::setprecision(10) << "time_s,label,context,source\n";
  for (const motion::MarkerEvent& event : sorted)
    text << event.time << "," << cell(event.label) << "," << cell(event.context) << ","
         << cell(event.source) << "\n";
  write_bytes(path, text.str());
}

}  // namespace coxa::io
