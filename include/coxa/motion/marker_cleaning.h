#pragma once

#include <coxa/motion/marker_data.h>

#include <string>
#include <vector>

namespace coxa::motion {

struct CleaningOptions {
  double longest_gap = 0.25;    ///< s, gaps up to this long are filled; 0: none
  double longest_curve = 0.10;  ///< s, of them those without three companions to carry the marker
  double jump = 20.0;           ///< mm, > 0, between a marker and where its last two frames lead
  double cutoff_hz = 0.0;  ///< low-pass (Butterworth, 4th order, forwards and backwards); 0: none
  /// Markers of one segment, which carry each other over gaps; labels that are absent are ignored.
  std::vector<std::vector<std::string>> segments = {};
};

/// A run of frames [begin, end) in which a marker was not seen, and what was done about it.
struct MarkerGap {
  std::string label;
  Index begin = 0, end = 0;
  enum class Fill { none, rigid, curve } fill = Fill::none;
};

struct CleanedMarkers {
  MarkerData markers;              ///< warnings of this step added
  std::vector<MarkerGap> gaps;     ///< of the recording after swaps and spikes were mended
  std::vector<std::string> swaps;  ///< "A and B from frame 12 (1.35 s) on", frames counted from 1
  std::vector<std::string>
      jumps;  ///< "A in frame 12 (31 mm)", spikes that were taken out or steps that stay
};

/// Exchanged labels put right, spikes taken out, gaps filled, and if asked smoothed; everything
/// reported.
///
/// Rules. Swap: in one frame two markers of a segment leave their paths by more than `jump` and
/// each lands on the other's; they are exchanged from there on. Spike: a marker leaves its path and
/// is back within `longest_curve`; the frames between count as not seen. A step that stays is
/// reported only. Gap: filled up to `longest_gap` if three companions of its segment are seen
/// throughout, by carrying the marker with them from both ends; else up to `longest_curve` by a
/// cubic through two frames on either side. Gaps at the ends stay open.
CleanedMarkers clean_markers(const MarkerData& markers, const CleaningOptions& options = {});

/// Runs of frames in which a marker is not seen.
std::vector<MarkerGap> find_gaps(const MarkerData& markers);

/// Zero-lag Butterworth low-pass: second order forwards and backwards (fourth in all), its cut-off
/// corrected for the two passes; each unbroken run by itself, runs shorter than 12 frames stay as
/// they are.
/// @throws Error bad_input unless 0 < cutoff_hz < rate / 2
Points low_pass(const Points& trajectory, double rate, double cutoff_hz);

}  // namespace coxa::motion
