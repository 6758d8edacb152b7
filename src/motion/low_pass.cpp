#include <coxa/motion/marker_cleaning.h>

#include <coxa/core/error.h>

#include <cmath>
#include <vector>

namespace coxa::motion {
namespace {

// second-order Butterworth section, bilinear transform
struct Section {
  double b0, b1, b2, a1, a2;
};

Section butterworth(double rate, double cutoff_hz) {
  const double w = std::tan(kPi * cutoff_hz / rate);
  const double scale = 1.0 / (1.0 + std::sqrt(2.0) * w + w * w);
  return {.b0 = w * w * scale,
          .b1 = 2.0 * w * w * scale,
          .b2 = w * w * scale,
          .a1 = 2.0 * (w * w - 1.0) * scale,
          .a2 = (1.0 - std::sqrt(2.0) * w + w * w) * scale};
}

// runs the section along x, started in the steady state of its first value
void update_by(const Section& s, std::vector<double>& x) {
  double x1 = x.front(), x2 = x.front(), y1 = x.front(), y2 = x.front();
  for (double& value : x) {
    const double y = s.b0 * value + s.b1 * x1 + s.b2 * x2 - s.a1 * y1 - s.a2 * y2;
    x2 = x1;
    x1 = value;
    y2 = y1;
    y1 = y;
    value = y;
  }
}

// forwards and backwards, both ends lengthened by point reflection so that they do not bend
std::vector<double> filtered(const std::vector<double>& x, const Section& section,
                             std::size_t padding) {
  std::vector<double> padded;
  for (std::size_t k = padding; k > 0; --k) padded.push_back(2.0 * x.front() - x[k]);
  padded.insert(padded.end(), x.begin(), x.end());
  for (std::size_t k = 1; k <= padding; ++k) padded.push_back(2.0 * x.back() - x[x.size() - 1 - k]);
  for (int pass = 0; pass < 2; ++pass) {
    update_by(section, padded);
    padded = {padded.rbegin(), padded.rend()};
  }
  const auto begin = padded.begin() + static_cast<std::ptrdiff_t>(padding);
  return {begin, begin + static_cast<std::ptrdiff_t>(x.size())};
}

}  // namespace

Points low_pass(const Points& trajectory, double rate, double cutoff_hz) {
  constexpr Index kShortest = 12;  // frames
  require(cutoff_hz > 0 && cutoff_hz < 0.5 * rate,
          "cutoff_hz must be above 0 and below half the frame rate (", 0.5 * rate, "), got ",
          cutoff_hz);
  // two passes halve the power twice: Winter's correction keeps -3 dB at the cut-off asked for
  const double corrected = std::min(cutoff_hz / std::pow(std::sqrt(2.0) - 1.0, 0.25), 0.49 * rate);
  const Section section = butterworth(rate, corrected);
  Points result = trajectory;
  const auto n = static_cast<Index>(trajectory.rows());
  for (Index begin = 0; begin < n;) {
    Index end = begin;
    while (end < n && seen(trajectory, end)) ++end;
    if (end - begin >= kShortest) {
      const auto padding = static_cast<std::size_t>(
          std::min<Index>(end - begin - 1, static_cast<Index>(rate / cutoff_hz) + 1));
      for (int k = 0; k < 3; ++k) {
        std::vector<double> x(static_cast<std::size_t>(end - begin));
        for (std::size_t i = 0; i < x.size(); ++i)
          x[i] = trajectory(begin + static_cast<Index>(i), k);
        const std::vector<double> y = filtered(x, section, padding);
        for (std::size_t i = 0; i < y.size(); ++i) result(begin + static_cast<Index>(i), k) = y[i];
      }
    }
    begin = std::max(end, begin + 1);
  }
  return result;
}

}  // namespace coxa::motion
