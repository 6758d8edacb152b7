#include <coxa/motion/marker_data.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <cctype>

namespace coxa::motion {
namespace {

bool same_ignoring_case(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

}  // namespace

std::optional<Index> find_marker(const MarkerData& markers, const std::string& label) {
  // an exact match wins over one that differs in case
  for (Index m = 0; m < markers.n_markers(); ++m) {
    if (markers.labels[m] == label) return m;
  }
  for (Index m = 0; m < markers.n_markers(); ++m) {
    if (same_ignoring_case(markers.labels[m], label)) return m;
  }
  return std::nullopt;
}

MarkerData frames_between(const MarkerData& markers, Index begin, Index end) {
  require(0 <= begin && begin < end && end <= markers.n_frames(), "frames [", begin, ", ", end,
          ") are not in the recording, which has ", markers.n_frames(), " frames");
  MarkerData part = markers;
  for (Points& trajectory : part.trajectories) {
    trajectory = Points(trajectory.middleRows(begin, end - begin));
  }
  part.first_time = markers.time(begin);
  return part;
}

}  // namespace coxa::motion
