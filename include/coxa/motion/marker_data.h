#pragma once

#include <coxa/core/types.h>

#include <optional>
#include <string>
#include <vector>

namespace coxa::motion {

/// Something the laboratory marked in time, for example a foot strike.
struct MarkerEvent {
  std::string label;                 ///< for example "Foot Strike"
  std::string context;               ///< for example "Right"; may be empty
  double time = 0.0;                 ///< s, on the recording's own clock
  std::string source = "recording";  ///< or the rule by which it was found
};

/// Trajectories of skin markers in the laboratory frame.
struct MarkerData {
  std::vector<std::string> labels;  ///< one per marker, unique
  std::vector<Points>
      trajectories;         ///< per marker frames×3, mm; a row of NaN where it was not seen
  double rate = 0.0;        ///< frames per second
  double first_time = 0.0;  ///< s, time of the first frame
  std::vector<MarkerEvent> events;
  std::vector<std::string> warnings;  ///< what was unusual in the file and how it was read

  Index n_markers() const { return static_cast<Index>(labels.size()); }
  Index n_frames() const {
    return trajectories.empty() ? 0 : static_cast<Index>(trajectories.front().rows());
  }
  double time(Index frame) const { return first_time + frame / rate; }
};

/// Number of the marker with that label, ignoring case; nullopt when absent.
std::optional<Index> find_marker(const MarkerData& markers, const std::string& label);

/// True where the marker was seen in that frame.
inline bool seen(const Points& trajectory, Index frame) {
  return trajectory.row(frame).allFinite();
}

/// The frames [begin, end) alone.
/// @throws Error bad_input if the range is empty or outside the recording
MarkerData frames_between(const MarkerData& markers, Index begin, Index end);

}  // namespace coxa::motion
