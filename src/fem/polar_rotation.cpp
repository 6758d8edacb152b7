#include "polar_rotation.h"

#include <Eigen/Geometry>
#include <cmath>

namespace coxa::fem {
namespace {

/// The matrix of cofactors: det(X) times the inverse transposed.
Mat3 cofactors(const Mat3& X) {
  Mat3 C;
  C << X.col(1).cross(X.col(2)), X.col(2).cross(X.col(0)), X.col(0).cross(X.col(1));
  return C;
}

/// Sum of the (signed) stretches: the largest root t of ((t² - a) / 2)² - 2 J t - b, with a and b
/// the first two invariants of F^T F. All roots are real, so Newton's iteration from the bound
/// sqrt(3 a) falls to the largest without passing it.
double sum_of_stretches(double a, double b, double J) {
  double t = std::sqrt(3.0 * a);
  for (int step = 0; step < kMaxSteps; ++step) {
    const double second = 0.5 * (t * t - a), slope = 2.0 * (second * t - J);
    if (!(slope > 0.0)) break;
    const double fall = (second * second - 2.0 * J * t - b) / slope;
    t -= fall;
    if (fall <= kLastStep * t) break;
  }
  return t;
}

}  // namespace

std::optional<Mat3> polar_rotation(const Mat3& F) {
  const Mat3 C = F.transpose() * F, cofactor = cofactors(F);
  const double a = C.trace(), b = cofactor.squaredNorm(), J = F.col(0).dot(cofactor.col(0));
  const double first = sum_of_stretches(a, b, J), second = 0.5 * (first * first - a);
  // the product of the sums of two stretches each; 8 size³ where all are equal
  const double product = first * second - J, squared_size = a / 3.0;
  if (!(product > kFlattest * 8.0 * squared_size * std::sqrt(squared_size))) return std::nullopt;
  // R is the slope of the sum of the stretches by F
  return Mat3(((second + a) * F + first * cofactor - F * C) / product);
}

}  // namespace coxa::fem
