#pragma once

#include <vector>

namespace coxa::fem {

/// A strain-stress (or rate-stress) curve: cubic pieces through given points, with continuous
/// slope.
///
/// The slopes are limited so that the curve rises wherever the points rise (Fritsch and Carlson
/// 1980); outside the points it goes on straight.
class Curve {
 public:
  /// @param x ascending, at least two   @param y stress at x, MPa
  /// @throws Error bad_input if the points are not ascending, not finite, or fewer than two
  Curve(std::vector<double> x, std::vector<double> y);
  /// The straight line through the origin.
  static Curve line(double slope);

  double value(double x) const;
  double slope(double x) const;
  /// Integral from 0 to x: the energy density.
  double integral(double x) const;

 private:
  /// Integral from the first point to x.
  double integral_from_start(double x) const;
  std::vector<double> x_, y_, slope_, integral_;
};

}  // namespace coxa::fem
