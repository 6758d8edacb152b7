#include <coxa/motion/marker_cleaning.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace coxa::motion {
namespace {

using Segment = std::vector<Index>;  // markers that move together

std::string when(const MarkerData& markers, Index frame) {
  return join_text("frame ", frame + 1, " (", std::round(1000.0 * markers.time(frame)) / 1000.0,
                   " s)");
}

std::vector<Segment> find_segments(const MarkerData& markers, const CleaningOptions& options) {
  std::vector<Segment> segments;
  for (const auto& labels : options.segments) {
    Segment segment;
    for (const std::string& label : labels) {
      if (const auto m = find_marker(markers, label)) segment.push_back(*m);
    }
    segments.push_back(segment);
  }
  return segments;
}

// where the two frames before lead; nullopt unless both were seen
std::optional<Vec3> led_to(const Points& trajectory, Index frame) {
  if (frame < 2 || !seen(trajectory, frame - 1) || !seen(trajectory, frame - 2))
    return std::nullopt;
  return Vec3(2.0 * trajectory.row(frame - 1) - trajectory.row(frame - 2));
}

// distance from the path in that frame; 0 where there is no path or no marker
double leap(const Points& trajectory, Index frame) {
  const auto expected = led_to(trajectory, frame);
  if (!expected || !seen(trajectory, frame)) return 0.0;
  return (trajectory.row(frame).transpose() - *expected).norm();
}

void update_swapped(CleanedMarkers& cleaned, const Segment& segment, double jump) {
  MarkerData& markers = cleaned.markers;
  auto& paths = markers.trajectories;
  for (Index frame = 2; frame < markers.n_frames(); ++frame) {
    for (std::size_t i = 0; i < segment.size(); ++i) {
      for (std::size_t j = i + 1; j < segment.size(); ++j) {
        Points &a = paths[static_cast<std::size_t>(segment[i])],
               &b = paths[static_cast<std::size_t>(segment[j])];
        const double leap_a = leap(a, frame), leap_b = leap(b, frame);
        if (leap_a <= jump || leap_b <= jump) continue;
        const double crossed_a = (b.row(frame).transpose() - *led_to(a, frame)).norm();
        const double crossed_b = (a.row(frame).transpose() - *led_to(b, frame)).norm();
        if (crossed_a > 0.25 * leap_a || crossed_b > 0.25 * leap_b) continue;
        const Points tail = a.bottomRows(markers.n_frames() - frame);
        a.bottomRows(tail.rows()) = b.bottomRows(tail.rows());
        b.bottomRows(tail.rows()) = tail;
        cleaned.swaps.push_back(markers.labels[static_cast<std::size_t>(segment[i])] + " and " +
                                markers.labels[static_cast<std::size_t>(segment[j])] + " from " +
                                when(markers, frame) + " on");
      }
    }
  }
}

// first frame after `frame` in which the marker is back on the path it left, at most `longest`
// frames away
std::optional<Index> back_on_path(const Points& path, Index frame, Index longest, double jump) {
  const Vec3 before = path.row(frame - 1), step = before - path.row(frame - 2).transpose();
  for (Index later = frame + 1; later < path.rows() && later - frame <= longest; ++later) {
    if (!seen(path, later)) continue;
    const Vec3 expected = before + static_cast<double>(later - frame + 1) * step;
    if ((path.row(later).transpose() - expected).norm() < 0.5 * jump) return later;
  }
  return std::nullopt;
}

void update_spikes(CleanedMarkers& cleaned, const CleaningOptions& options) {
  MarkerData& markers = cleaned.markers;
  const auto longest = static_cast<Index>(options.longest_curve * markers.rate);
  for (Index m = 0; m < markers.n_markers(); ++m) {
    Points& path = markers.trajectories[static_cast<std::size_t>(m)];
    for (Index frame = 2; frame < markers.n_frames(); ++frame) {
      const double height = leap(path, frame);
      if (height <= options.jump) continue;
      const auto back = back_on_path(path, frame, longest, options.jump);
      cleaned.jumps.push_back(
          markers.labels[static_cast<std::size_t>(m)] + " in " + when(markers, frame) +
          join_text(", ", std::lround(height), " mm, ", back ? "taken out" : "left as it is"));
      if (back) {
        path.middleRows(frame, *back - frame).setConstant(kNaN);
        frame = *back + 1;
      } else {
        ++frame;  // the frame after a step has no path yet
      }
    }
  }
}

// companions of the marker that are seen in all frames [begin, end)
Segment companions(const MarkerData& markers, const std::vector<Segment>& segments, Index marker,
                   Index begin, Index end) {
  for (const Segment& segment : segments) {
    if (std::find(segment.begin(), segment.end(), marker) == segment.end()) continue;
    Segment result;
    for (const Index other : segment) {
      const Points& path = markers.trajectories[static_cast<std::size_t>(other)];
      if (other != marker && path.middleRows(begin, end - begin).allFinite())
        result.push_back(other);
    }
    return result;
  }
  return {};
}

Points rows_at(const MarkerData& markers, const Segment& segment, Index frame) {
  Points p(static_cast<Eigen::Index>(segment.size()), 3);
  for (std::size_t k = 0; k < segment.size(); ++k) {
    p.row(static_cast<Eigen::Index>(k)) =
        markers.trajectories[static_cast<std::size_t>(segment[k])].row(frame);
  }
  return p;
}

// carried from both ends by the companions, the two results mixed by their distance in time
void fill_rigidly(const MarkerData& markers, const Segment& others, Points& path, Index begin,
                  Index end) {
  const Vec3 first = path.row(begin - 1), last = path.row(end);
  for (Index frame = begin; frame < end; ++frame) {
    const Points now = rows_at(markers, others, frame);
    const Vec3 a = fit_rigid(rows_at(markers, others, begin - 1), now) * first;
    const Vec3 b = fit_rigid(rows_at(markers, others, end), now) * last;
    const double share =
        static_cast<double>(frame + 1 - begin) / static_cast<double>(end + 1 - begin);
    path.row(frame) = (1.0 - share) * a + share * b;
  }
}

// cubic with the positions and velocities at both ends
void fill_by_curve(Points& path, Index begin, Index end) {
  const Vec3 a = path.row(begin - 1), b = path.row(end);
  const Vec3 va = a - path.row(begin - 2).transpose(), vb = path.row(end + 1).transpose() - b;
  const double h = static_cast<double>(end - begin + 1);
  for (Index frame = begin; frame < end; ++frame) {
    const double s = static_cast<double>(frame + 1 - begin) / h, s2 = s * s, s3 = s2 * s;
    path.row(frame) = (2 * s3 - 3 * s2 + 1) * a + (s3 - 2 * s2 + s) * h * va +
                      (-2 * s3 + 3 * s2) * b + (s3 - s2) * h * vb;
  }
}

void fill_gap(const MarkerData& markers, const std::vector<Segment>& segments,
              const CleaningOptions& options, MarkerData& filled, MarkerGap& gap) {
  constexpr double kRounding = 1e-9;  // s
  const Index marker = *find_marker(markers, gap.label);
  Points& path = filled.trajectories[static_cast<std::size_t>(marker)];
  const Points& recorded = markers.trajectories[static_cast<std::size_t>(marker)];
  const double seconds = (gap.end - gap.begin) / markers.rate - kRounding;
  if (gap.begin == 0 || gap.end == markers.n_frames() || seconds > options.longest_gap) return;
  const Segment others = companions(markers, segments, marker, gap.begin - 1, gap.end + 1);
  if (others.size() >= 3) {
    fill_rigidly(markers, others, path, gap.begin, gap.end);
    gap.fill = MarkerGap::Fill::rigid;
    return;
  }
  const bool room = gap.begin >= 2 && gap.end + 1 < markers.n_frames() &&
                    seen(recorded, gap.begin - 2) && seen(recorded, gap.end + 1);
  if (!room || seconds > options.longest_curve) return;
  fill_by_curve(path, gap.begin, gap.end);
  gap.fill = MarkerGap::Fill::curve;
}

void add_warnings(CleanedMarkers& cleaned) {
  auto& warnings = cleaned.markers.warnings;
  for (const std::string& swap : cleaned.swaps) warnings.push_back("labels exchanged: " + swap);
  for (const std::string& jump : cleaned.jumps) warnings.push_back("jump: " + jump);
  Index filled = 0, open = 0;
  for (const MarkerGap& gap : cleaned.gaps)
    (gap.fill == MarkerGap::Fill::none ? open : filled) += gap.end - gap.begin;
  if (filled > 0) warnings.push_back(join_text(filled, " marker positions in gaps were filled"));
  if (open > 0) warnings.push_back(join_text(open, " marker positions are missing"));
}

}  // namespace

std::vector<MarkerGap> find_gaps(const MarkerData& markers) {
  std::vector<MarkerGap> gaps;
  for (Index m = 0; m < markers.n_markers(); ++m) {
    const Points& path = markers.trajectories[static_cast<std::size_t>(m)];
    for (Index begin = 0; begin < markers.n_frames(); ++begin) {
      if (seen(path, begin)) continue;
      Index end = begin;
      while (end < markers.n_frames() && !seen(path, end)) ++end;
      gaps.push_back(
          {.label = markers.labels[static_cast<std::size_t>(m)], .begin = begin, .end = end});
      begin = end;
    }
  }
  return gaps;
}

CleanedMarkers clean_markers(const MarkerData& markers, const CleaningOptions& options) {
  require(options.longest_gap >= 0 && options.longest_curve >= 0,
          "the longest gaps must not be negative, got ", options.longest_gap, " and ",
          options.longest_curve, " s");
  require(options.jump > 0, "jump must be above 0 mm, got ", options.jump);
  CleanedMarkers cleaned{.markers = markers, .gaps = {}, .swaps = {}, .jumps = {}};
  const std::vector<Segment> segments = find_segments(markers, options);
  for (const Segment& segment : segments) update_swapped(cleaned, segment, options.jump);
  update_spikes(cleaned, options);
  cleaned.gaps = find_gaps(cleaned.markers);
  // companions must have been seen, not filled themselves: read from a copy
  const MarkerData recorded = cleaned.markers;
  for (MarkerGap& gap : cleaned.gaps) fill_gap(recorded, segments, options, cleaned.markers, gap);
  if (options.cutoff_hz > 0) {
    for (Points& path : cleaned.markers.trajectories)
      path = low_pass(path, markers.rate, options.cutoff_hz);
  }
  add_warnings(cleaned);
  return cleaned;
}

}  // namespace coxa::motion
