#include <coxa/fem/curve.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <cmath>

namespace coxa::fem {
namespace {

using Size = std::size_t;

/// Slopes at the points that keep each piece monotone (Fritsch and Carlson 1980).
std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y) {
  const Size n = x.size();
  std::vector<double> secant(n - 1), slope(n);
  for (Size k = 0; k + 1 < n; ++k) secant[k] = (y[k + 1] - y[k]) / (x[k + 1] - x[k]);
  slope.front() = secant.front();
  slope.back() = secant.back();
  for (Size k = 1; k + 1 < n; ++k)
    slope[k] = secant[k - 1] * secant[k] <= 0.0 ? 0.0 : 0.5 * (secant[k - 1] + secant[k]);
  for (Size k = 0; k + 1 < n; ++k) {
    if (secant[k] == 0.0) {
      slope[k] = slope[k + 1] = 0.0;
      continue;
    }
    const double a = slope[k] / secant[k], b = slope[k + 1] / secant[k];
    const double length = std::hypot(a, b);
    if (length > 3.0) {
      slope[k] *= 3.0 / length;
      slope[k + 1] *= 3.0 / length;
    }
  }
  return slope;
}

}  // namespace

Curve::Curve(std::vector<double> x, std::vector<double> y) : x_(std::move(x)), y_(std::move(y)) {
  require(x_.size() >= 2 && x_.size() == y_.size(), "a curve needs two points or more, got ",
          x_.size(), " abscissae and ", y_.size(), " values");
  for (Size k = 0; k < x_.size(); ++k) {
    require(std::isfinite(x_[k]) && std::isfinite(y_[k]), "point ", k, " of a curve is not finite");
    require(k == 0 || x_[k] > x_[k - 1], "point ", k, " of a curve does not ascend: ", x_[k],
            " after ", x_[k == 0 ? 0 : k - 1]);
  }
  slope_ = monotone_slopes(x_, y_);
  integral_ = {0.0};
  for (Size k = 0; k + 1 < x_.size(); ++k) {
    const double h = x_[k + 1] - x_[k];
    integral_.push_back(integral_[k] + 0.5 * h * (y_[k] + y_[k + 1]) +
                        h * h / 12.0 * (slope_[k] - slope_[k + 1]));
  }
}

Curve Curve::line(double slope) { return Curve({-1.0, 1.0}, {-slope, slope}); }

double Curve::value(double x) const {
  if (x <= x_.front()) return y_.front() + slope_.front() * (x - x_.front());
  if (x >= x_.back()) return y_.back() + slope_.back() * (x - x_.back());
  const Size k = static_cast<Size>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()) - 1;
  const double h = x_[k + 1] - x_[k], t = (x - x_[k]) / h, s = 1.0 - t;
  return s * s * ((1.0 + 2.0 * t) * y_[k] + t * h * slope_[k]) +
         t * t * ((1.0 + 2.0 * s) * y_[k + 1] - s * h * slope_[k + 1]);
}

double Curve::slope(double x) const {
  if (x <= x_.front()) return slope_.front();
  if (x >= x_.back()) return slope_.back();
  const Size k = static_cast<Size>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()) - 1;
  const double h = x_[k + 1] - x_[k], t = (x - x_[k]) / h, s = 1.0 - t;
  return 6.0 * s * t * (y_[k + 1] - y_[k]) / h + s * (s - 2.0 * t) * slope_[k] +
         t * (t - 2.0 * s) * slope_[k + 1];
}

double Curve::integral(double x) const { return integral_from_start(x) - integral_from_start(0.0); }

double Curve::integral_from_start(double x) const {
  if (x <= x_.front()) {
    const double d = x - x_.front();
    return d * (y_.front() + 0.5 * slope_.front() * d);
  }
  if (x >= x_.back()) {
    const double d = x - x_.back();
    return integral_.back() + d * (y_.back() + 0.5 * slope_.back() * d);
  }
  const Size k = static_cast<Size>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()) - 1;
  const double h = x_[k + 1] - x_[k], t = (x - x_[k]) / h;
  // integrals of the four Hermite polynomials from 0 to t
  const double t2 = t * t, t3 = t2 * t, t4 = t3 * t;
  return integral_[k] + h * (y_[k] * (t - t3 + 0.5 * t4) + y_[k + 1] * (t3 - 0.5 * t4) +
                             h * slope_[k] * (0.5 * t2 - 2.0 / 3.0 * t3 + 0.25 * t4) +
                             h * slope_[k + 1] * (0.25 * t4 - t3 / 3.0));
}

}  // namespace coxa::fem
