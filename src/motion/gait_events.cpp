#include <coxa/motion/gait_events.h>

#include <coxa/core/error.h>
#include <coxa/motion/marker_cleaning.h>
#include <coxa/motion/marker_map.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

namespace coxa::motion {
namespace {

constexpr double kCutoff = 7.0;  // Hz
// a peak stands alone for this long on both sides; strides take 0.8 s and more, s
constexpr double kAlone = 0.25;
// of the whole way of the foot: a peak rises at least so far above what is near it
constexpr double kProminence = 0.15;
// walking moves the heel so far before and behind the pelvis; less is standing or shifting, mm
constexpr double kShortestWay = 250.0;
// the heels' largest movement goes along the feet; in a squat it does not
constexpr double kAlongFeet = 0.7;

std::optional<Points> path_of(const MarkerData& markers, const std::vector<std::string>& labels) {
  for (const std::string& pattern : labels) {
    for (std::size_t m = 0; m < markers.labels.size(); ++m) {
      if (!label_matches(markers.labels[m], pattern)) continue;
      const Points& path = markers.trajectories[m];
      return markers.rate > 2.0 * kCutoff ? low_pass(path, markers.rate, kCutoff) : path;
    }
  }
  return std::nullopt;
}

// the sacrum, else midway between the PSIS
std::optional<Points> pelvis_path(const MarkerData& markers) {
  const MarkerMap map = default_marker_map(Side::right);
  if (const auto sacrum = path_of(markers, map.at(MarkerRole::sacrum))) return sacrum;
  const auto left = path_of(markers, map.at(MarkerRole::psis_left)),
             right = path_of(markers, map.at(MarkerRole::psis_right));
  if (!left || !right) return std::nullopt;
  return Points(0.5 * (*left + *right));
}

struct Foot {
  const char* context;
  Points heel, toe;  // from the pelvis
};

// direction of the heels' largest movement, forwards; zero where the feet do not point along it
Vec3 walking_direction(const std::vector<Foot>& feet) {
  Mat3 spread = Mat3::Zero();
  Vec3 forward = Vec3::Zero();
  for (const Foot& foot : feet) {
    Vec3 mean = Vec3::Zero();
    double n = 0.0;
    for (Index f = 0; f < foot.heel.rows(); ++f) {
      if (seen(foot.heel, f)) mean += foot.heel.row(f), n += 1.0;
    }
    mean /= std::max(1.0, n);
    for (Index f = 0; f < foot.heel.rows(); ++f) {
      if (!seen(foot.heel, f)) continue;
      const Vec3 d = foot.heel.row(f).transpose() - mean;
      spread += d * d.transpose();
      if (seen(foot.toe, f)) forward += (foot.toe.row(f) - foot.heel.row(f)).normalized();
    }
  }
  const Vec3 along = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(2);
  const double cosine = along.dot(forward.normalized());
  if (!(std::abs(cosine) >= kAlongFeet)) return Vec3::Zero();
  return cosine > 0 ? along : Vec3(-along);
}

double range_of(const VecX& x) {
  double low = kInfinity, high = -kInfinity;
  for (const double value : x) {
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  }
  return high - low;
}

// frames, with fractions, where x is largest for `alone` frames on both sides
std::vector<double> peaks_of(const VecX& x, Index alone, double prominence) {
  std::vector<double> peaks;
  for (Index f = alone; f + alone < x.size(); ++f) {
    const auto around = x.segment(f - alone, 2 * alone + 1);
    if (!around.allFinite() || x[f] < around.maxCoeff() || x[f] == x[f - 1]) continue;
    const double lowest = std::max(around.head(alone).minCoeff(), around.tail(alone).minCoeff());
    if (x[f] - lowest < prominence) continue;
    const double bend = x[f - 1] - 2.0 * x[f] + x[f + 1];
    peaks.push_back(f + (bend < 0 ? 0.5 * (x[f - 1] - x[f + 1]) / bend : 0.0));
  }
  return peaks;
}

}  // namespace

FoundEvents find_gait_events(const MarkerData& markers, const FootLabels& labels) {
  const auto pelvis = pelvis_path(markers);
  if (!pelvis) return {{}, "no marker of the sacrum or of both PSIS"};
  std::vector<Foot> feet;
  for (const auto& [context, heel_labels, toe_labels] :
       {std::tuple{"Left", &labels.heel_left, &labels.toe_left},
        std::tuple{"Right", &labels.heel_right, &labels.toe_right}}) {
    const auto heel = path_of(markers, *heel_labels), toe = path_of(markers, *toe_labels);
    if (heel && toe) feet.push_back({context, *heel - *pelvis, *toe - *pelvis});
  }
  if (feet.empty()) return {{}, "no foot with markers of heel and toe"};
  const Vec3 forward = walking_direction(feet);
  if (forward.isZero()) return {{}, "the heels do not move along the feet: no walking"};
  FoundEvents found;
  const auto alone = std::max<Index>(2, std::lround(kAlone * markers.rate));
  for (const Foot& foot : feet) {
    const VecX heel = foot.heel * forward, toe = -foot.toe * forward;
    const double way = range_of(heel);
    if (!(way >= kShortestWay)) continue;
    for (const auto& [label, x] : {std::pair{"Foot Strike", &heel}, std::pair{"Foot Off", &toe}}) {
      for (const double frame : peaks_of(*x, alone, kProminence * way))
        found.events.push_back({label, foot.context, markers.first_time + frame / markers.rate,
                                "heel and toe (Zeni 2008)"});
    }
  }
  std::stable_sort(found.events.begin(), found.events.end(),
                   [](const MarkerEvent& a, const MarkerEvent& b) { return a.time < b.time; });
  if (found.events.empty()) found.reason = "no heel passes the pelvis as in walking";
  return found;
}

}  // namespace coxa::motion
