#include <coxa/motion/clinical_pattern.h>

#include <coxa/core/error.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coxa::motion {
namespace {

Vec3 as_vector(const HipAngles& a) { return {a.flexion, a.adduction, a.internal_rotation}; }
HipAngles as_angles(const Vec3& v) {
  return {.flexion = v[0], .adduction = v[1], .internal_rotation = v[2]};
}
double smooth_step(double s) { return s * s * (3.0 - 2.0 * s); }

void check_pattern(const ClinicalPattern& pattern) {
  require(pattern.poses.size() >= 2, "the movement '", pattern.name, "' has ", pattern.poses.size(),
          " poses; 2 are needed");
  require(pattern.poses.front().time == 0.0, "the movement '", pattern.name,
          "' must begin at time 0");
  for (std::size_t k = 0; k < pattern.poses.size(); ++k) {
    require(as_vector(pattern.poses[k].angles).allFinite(), "pose ", k + 1, " of the movement '",
            pattern.name, "' is not finite");
    require(k == 0 || pattern.poses[k].time > pattern.poses[k - 1].time,
            "the times of the movement '", pattern.name, "' must increase, pose ", k + 1,
            " does not");
  }
  if (pattern.interpolation == Interpolation::periodic) {
    const Vec3 gap =
        as_vector(pattern.poses.back().angles) - as_vector(pattern.poses.front().angles);
    require(gap.cwiseAbs().maxCoeff() < radians(0.5), "the periodic movement '", pattern.name,
            "' does not end where it begins");
  }
}

// slopes of the periodic cubic spline through the poses (continuous second derivative), n×3
MatX periodic_slopes(const std::vector<PatternPose>& poses) {
  const auto n = static_cast<Eigen::Index>(poses.size()) - 1;
  MatX A = MatX::Zero(n, n), b = MatX::Zero(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(k),
               before = static_cast<std::size_t>(k == 0 ? n - 1 : k - 1);
    const double h0 = poses[before + 1].time - poses[before].time,
                 h1 = poses[i + 1].time - poses[i].time;
    const Vec3 d0 = (as_vector(poses[before + 1].angles) - as_vector(poses[before].angles)) / h0;
    const Vec3 d1 = (as_vector(poses[i + 1].angles) - as_vector(poses[i].angles)) / h1;
    A(k, static_cast<Eigen::Index>(before)) += 1.0 / h0;
    A(k, k) += 2.0 * (1.0 / h0 + 1.0 / h1);
    A(k, (k + 1) % n) += 1.0 / h1;
    b.row(k) = 3.0 * (d0 / h0 + d1 / h1);
  }
  MatX slopes(n + 1, 3);
  slopes.topRows(n) = A.partialPivLu().solve(b);
  slopes.row(n) = slopes.row(0);
  return slopes;
}

Vec3 hermite(const PatternPose& a, const PatternPose& b, const Vec3& slope_a, const Vec3& slope_b,
             double s) {
  const double h = b.time - a.time, s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * as_vector(a.angles) + (s3 - 2 * s2 + s) * h * slope_a +
         (-2 * s3 + 3 * s2) * as_vector(b.angles) + (s3 - s2) * h * slope_b;
}

// evaluates a checked pattern; the spline's slopes are found once
class Curve {
 public:
  explicit Curve(const ClinicalPattern& pattern) : pattern_(pattern) {
    check_pattern(pattern);
    if (pattern.interpolation == Interpolation::periodic) slopes_ = periodic_slopes(pattern.poses);
  }
  double duration() const { return pattern_.poses.back().time; }
  Vec3 operator()(double time) const {
    const auto& poses = pattern_.poses;
    time = std::clamp(time, 0.0, duration());
    std::size_t k = 0;
    while (k + 2 < poses.size() && time >= poses[k + 1].time) ++k;
    const PatternPose &a = poses[k], &b = poses[k + 1];
    const double s = (time - a.time) / (b.time - a.time);
    if (pattern_.interpolation == Interpolation::periodic) {
      const auto row = static_cast<Eigen::Index>(k);
      return hermite(a, b, slopes_.row(row), slopes_.row(row + 1), s);
    }
    const double share = pattern_.interpolation == Interpolation::smooth ? smooth_step(s) : s;
    return (1.0 - share) * as_vector(a.angles) + share * as_vector(b.angles);
  }

 private:
  const ClinicalPattern& pattern_;  // outlived by the caller's pattern
  MatX slopes_;
};

}  // namespace

HipAngles angles_at(const ClinicalPattern& pattern, double time) {
  return as_angles(Curve(pattern)(time));
}

HipMotion make_movement(const ClinicalPattern& pattern, Side side, const MovementOptions& options) {
  require(options.rate > 0, "the rate must be above 0 frames per second, got ", options.rate);
  require(options.n_frames == 0 || options.n_frames >= 2, "n_frames must be 0 or at least 2, got ",
          options.n_frames);
  require(options.cycles >= 1, "cycles must be at least 1, got ", options.cycles);
  require(options.cycles == 1 || pattern.interpolation == Interpolation::periodic,
          "only a periodic movement can be repeated, '", pattern.name, "' is not");
  const Curve curve(pattern);
  const double duration = curve.duration(), total = duration * options.cycles;
  const Index n =
      options.n_frames > 0
          ? options.n_frames
          : std::max<Index>(2, static_cast<Index>(std::ceil(total * options.rate - 1e-9)) + 1);
  HipMotion motion;
  motion.method = "pattern " + pattern.name;
  for (Index k = 0; k < n; ++k) {
    const double time = k + 1 == n ? total : total * k / (n - 1);
    const double in_cycle = k + 1 == n ? duration : std::fmod(time, duration);
    const HipAngles angles = as_angles(curve(in_cycle));
    motion.time.push_back(time);
    motion.angles.push_back(angles);
    motion.X_PF.push_back({rotation_from_angles(angles, side), Vec3::Zero()});
  }
  return motion;
}

ClinicalPattern blended(const ClinicalPattern& first, const ClinicalPattern& second, double blend) {
  constexpr double kStep = 0.02;  // s between the poses of the result
  const Curve a(first), b(second);
  require(blend >= 0 && blend <= std::min(a.duration(), b.duration()), "blend must be in [0, ",
          std::min(a.duration(), b.duration()), "] s, got ", blend);
  const double join = a.duration() - blend, total = join + b.duration();
  require(blend > 0 || (a(a.duration()) - b(0.0)).norm() < radians(1.0), "'", first.name,
          "' ends elsewhere than '", second.name, "' begins: give a blend time");
  ClinicalPattern result{.name = first.name + "+" + second.name,
                         .description = first.description + "; " + second.description,
                         .source = first.source + "; " + second.source,
                         .interpolation = Interpolation::linear,
                         .poses = {}};
  const auto n = static_cast<Index>(std::ceil(total / kStep)) + 1;
  for (Index k = 0; k < n; ++k) {
    const double time = total * k / (n - 1);
    const double share = blend > 0 ? smooth_step(std::clamp((time - join) / blend, 0.0, 1.0))
                                   : (time >= join ? 1.0 : 0.0);
    result.poses.push_back({time, as_angles((1.0 - share) * a(time) + share * b(time - join))});
  }
  return result;
}

ClinicalPattern simple_pattern(const std::string& name, const HipAngles& from, const HipAngles& to,
                               double duration) {
  return {.name = name,
          .description = "from one pose to another",
          .source = "prescribed",
          .interpolation = Interpolation::smooth,
          .poses = {{0.0, from}, {duration, to}}};
}

}  // namespace coxa::motion
