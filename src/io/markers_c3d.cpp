#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/markers.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "c3d_parameters.h"
#include "marker_units.h"

// The C3D format as documented at c3d.org (C3D User Guide): 512-byte blocks; a header, parameters,
// frames.
namespace coxa::io {
namespace {

constexpr std::size_t kBlock = 512;

struct Layout {
  std::size_t n_points = 0, n_analog = 0;  // per frame
  std::size_t n_frames = 0, first_frame = 1;
  std::size_t data_start = 0;  // byte
  double scale = 0.0, rate = 0.0;
  bool real = false;
  std::size_t word_bytes() const { return real ? 4 : 2; }
  std::size_t frame_bytes() const { return (4 * n_points + n_analog) * word_bytes(); }
};

C3dBytes load(const std::filesystem::path& path) {
  const std::string text = read_bytes(path);
  std::vector<unsigned char> bytes(text.begin(), text.end());
  if (bytes.size() < 2 * kBlock || bytes[1] != 0x50) {
    fail(ErrorCode::bad_file, path.string(),
         ": not a C3D file (byte 2 is not 0x50, or shorter than two blocks)");
  }
  return C3dBytes(std::move(bytes), path.string());
}

// sets the processor and returns the byte where the parameters start
std::size_t find_parameters(C3dBytes& file) {
  const std::size_t block = file.byte(0);
  if (block == 0) fail(ErrorCode::bad_file, file.name(), ": the header names no parameter section");
  const std::size_t start = (block - 1) * kBlock;
  const int processor = file.byte(start + 3);
  if (processor < 84 || processor > 86) {
    fail(ErrorCode::bad_file, file.name(), ": unknown processor ", processor,
         " (84 Intel, 85 DEC, 86 SGI)");
  }
  file.set_processor(static_cast<C3dProcessor>(processor));
  return start;
}

double number(const C3dParameters& parameters, const std::string& key, double otherwise) {
  const auto it = parameters.find(key);
  return it == parameters.end() || it->second.numbers.empty() ? otherwise
                                                              : it->second.numbers.front();
}

// a frame number that was split into two 16-bit words when it outgrew one
std::optional<std::size_t> split_number(const C3dParameters& parameters, const std::string& key) {
  const auto it = parameters.find(key);
  if (it == parameters.end() || it->second.numbers.size() < 2) return std::nullopt;
  const auto part = [&](std::size_t k) {
    return static_cast<std::uint16_t>(static_cast<int>(it->second.numbers[k]));
  };
  return part(0) + std::size_t{65536} * part(1);
}

bool usable(double x) { return std::isfinite(x) && x != 0.0; }

Layout read_layout(const C3dBytes& file, const C3dParameters& parameters,
                   std::vector<std::string>& warnings) {
  Layout layout;
  layout.n_points = file.word(2);
  layout.n_analog = file.word(4);
  layout.first_frame = split_number(parameters, "TRIAL:ACTUAL_START_FIELD").value_or(file.word(6));
  const std::size_t last =
      split_number(parameters, "TRIAL:ACTUAL_END_FIELD").value_or(file.word(8));
  layout.scale = file.real(12);
  if (!usable(layout.scale)) layout.scale = number(parameters, "POINT:SCALE", 0.0);
  layout.rate = file.real(20);
  if (!(layout.rate > 0) || !std::isfinite(layout.rate))
    layout.rate = number(parameters, "POINT:RATE", 0.0);
  std::size_t block = file.word(16);
  if (block == 0) block = static_cast<std::size_t>(number(parameters, "POINT:DATA_START", 0.0));

  const auto refuse = [&](const auto&... parts) {
    fail(ErrorCode::bad_file, file.name(), ": ", parts...);
  };
  if (layout.n_points == 0) refuse("no marker is stored (the header counts 0 points)");
  if (!usable(layout.scale)) refuse("neither header nor POINT:SCALE gives a usable scale");
  if (!(layout.rate > 0)) refuse("neither header nor POINT:RATE gives a frame rate");
  if (block < 2) refuse("no place is given where the frames start");
  if (last < layout.first_frame)
    refuse("last frame ", last, " stands before the first, ", layout.first_frame);
  layout.real = layout.scale < 0;
  layout.data_start = (block - 1) * kBlock;
  layout.n_frames = last - layout.first_frame + 1;

  const double used = number(parameters, "POINT:USED", static_cast<double>(layout.n_points));
  if (used != static_cast<double>(layout.n_points)) {
    warnings.push_back(join_text("POINT:USED says ", used, " markers, the header ", layout.n_points,
                                 "; the header is used"));
  }
  const std::size_t available = file.size() > layout.data_start
                                    ? (file.size() - layout.data_start) / layout.frame_bytes()
                                    : 0;
  if (available == 0) refuse("the file ends before its first frame");
  if (available < layout.n_frames) {
    warnings.push_back(join_text("the file is cut short: ", available, " of ", layout.n_frames,
                                 " frames are there"));
    layout.n_frames = available;
  }
  return layout;
}

// labels of all points: blanks and repeats get names of their own, "subject:" prefixes go
std::vector<std::string> read_labels(const C3dParameters& parameters, std::size_t n_points,
                                     std::vector<std::string>& warnings) {
  std::vector<std::string> labels;
  for (int part = 1;; ++part) {
    const auto it =
        parameters.find(part == 1 ? "POINT:LABELS" : "POINT:LABELS" + std::to_string(part));
    if (it == parameters.end()) break;
    labels.insert(labels.end(), it->second.texts.begin(), it->second.texts.end());
  }
  labels.resize(n_points);
  std::set<std::string> taken;
  std::size_t unnamed = 0;
  for (std::size_t k = 0; k < n_points; ++k) {
    std::string& label = labels[k];
    label = label.substr(label.rfind(':') == std::string::npos ? 0 : label.rfind(':') + 1);
    while (!label.empty() && label.front() == ' ') label.erase(0, 1);
    if (label.empty()) {
      label = "unnamed_" + std::to_string(k + 1);
      ++unnamed;
    }
    const std::string wanted = label;
    for (int repeat = 2; !taken.insert(label).second; ++repeat)
      label = wanted + "_" + std::to_string(repeat);
    if (label != wanted)
      warnings.push_back("the label '" + wanted + "' stands twice; the later one is called '" +
                         label + "'");
  }
  if (unnamed > 0)
    warnings.push_back(join_text(unnamed, " markers have no label; they are called unnamed_N"));
  return labels;
}

// true for points that hold computed angles, forces, moments or powers and no position
std::vector<bool> find_outputs(const C3dParameters& parameters,
                               const std::vector<std::string>& labels) {
  std::set<std::string> outputs;
  for (const char* group : {"ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS"}) {
    const auto it = parameters.find(std::string("POINT:") + group);
    if (it == parameters.end()) continue;
    for (const std::string& label : it->second.texts)
      outputs.insert(label.substr(label.rfind(':') + 1));
  }
  std::vector<bool> is_output;
  for (const std::string& label : labels) is_output.push_back(outputs.contains(label));
  return is_output;
}

Points read_trajectory(const C3dBytes& file, const Layout& layout, std::size_t point) {
  Points trajectory(static_cast<Eigen::Index>(layout.n_frames), 3);
  for (std::size_t frame = 0; frame < layout.n_frames; ++frame) {
    const std::size_t at =
        layout.data_start + frame * layout.frame_bytes() + point * 4 * layout.word_bytes();
    const auto value = [&](std::size_t k) {
      return layout.real ? file.real(at + 4 * k) : file.integer(at + 2 * k) * layout.scale;
    };
    const double residual = layout.real ? value(3) : file.integer(at + 6);
    Vec3 position(value(0), value(1), value(2));
    const bool missing = residual < 0 || !position.allFinite() || position.isZero(0.0);
    if (missing) position.setConstant(kNaN);
    trajectory.row(static_cast<Eigen::Index>(frame)) = position;
  }
  return trajectory;
}

bool printable(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return c >= 32 && c < 127; });
}

std::vector<motion::MarkerEvent> read_events(const C3dParameters& parameters,
                                             std::vector<std::string>& warnings) {
  std::vector<motion::MarkerEvent> events;
  const auto labels = parameters.find("EVENT:LABELS"), times = parameters.find("EVENT:TIMES");
  const auto contexts = parameters.find("EVENT:CONTEXTS");
  const auto n = static_cast<std::size_t>(std::max(0.0, number(parameters, "EVENT:USED", 0.0)));
  if (n > 0 && (labels == parameters.end() || times == parameters.end())) {
    warnings.push_back(
        join_text(n, " events are announced, but their labels or times are missing; none is used"));
    return events;
  }
  for (std::size_t k = 0; k < n; ++k) {
    if (k >= labels->second.texts.size() || 2 * k + 1 >= times->second.numbers.size()) break;
    motion::MarkerEvent event{.label = labels->second.texts[k], .context = "", .time = 0.0};
    if (contexts != parameters.end() && k < contexts->second.texts.size())
      event.context = contexts->second.texts[k];
    event.time = 60.0 * times->second.numbers[2 * k] + times->second.numbers[2 * k + 1];
    if (printable(event.label + event.context) && std::isfinite(event.time)) {
      events.push_back(event);
    } else {
      warnings.push_back(join_text("event ", k + 1, " is damaged and left out"));
    }
  }
  return events;
}

}  // namespace

motion::MarkerData read_c3d(const std::filesystem::path& path) {
  C3dBytes file = load(path);
  const std::size_t start = find_parameters(file);
  motion::MarkerData markers;

  // parameters end where the frames start, whatever they say themselves
  const std::size_t data_block = file.word(16);
  const std::size_t limit =
      data_block > start / kBlock + 1 ? (data_block - 1) * kBlock : file.size();
  const C3dParameters parameters =
      read_c3d_parameters(file, start, std::min(limit, file.size()), markers.warnings);
  const Layout layout = read_layout(file, parameters, markers.warnings);
  markers.rate = layout.rate;
  markers.first_time = (static_cast<double>(layout.first_frame) - 1.0) / layout.rate;
  markers.events = read_events(parameters, markers.warnings);

  const std::vector<std::string> labels =
      read_labels(parameters, layout.n_points, markers.warnings);
  const std::vector<bool> is_output = find_outputs(parameters, labels);
  for (std::size_t point = 0; point < layout.n_points; ++point) {
    if (is_output[point]) continue;
    markers.labels.push_back(labels[point]);
    markers.trajectories.push_back(read_trajectory(file, layout, point));
  }
  const auto n_outputs = std::count(is_output.begin(), is_output.end(), true);
  if (n_outputs > 0) {
    markers.warnings.push_back(join_text(
        n_outputs, " computed angles, forces, moments or powers are not markers and are left out"));
  }
  const auto units = parameters.find("POINT:UNITS");
  const bool known = units != parameters.end() && !units->second.texts.empty();
  convert_to_mm(markers, known ? units->second.texts.front() : "", path.string());
  return markers;
}

}  // namespace coxa::io
