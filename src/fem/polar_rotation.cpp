#include "polar_rotation.h"

#include <Eigen/Geometry>

namespace coxa::fem {
namespace {

// less volume than this share of the cube of the mean stretch is left to the singular values
constexpr double kFlattest = 0.02;
// a step so small leaves an error of its square
constexpr double kLastStep = 1e-8;
constexpr int kMaxSteps = 12;

/// The matrix of cofactors: det(X) times the inverse transposed.
Mat3 cofactors(const Mat3& X) {
  Mat3 C;
  C << X.col(1).cross(X.col(2)), X.col(2).cross(X.col(0)), X.col(0).cross(X.col(1));
  return C;
}

}  // namespace

std::optional<Mat3> polar_rotation(const Mat3& F) {
  const double size = F.squaredNorm() / 3.0;
  Mat3 X = F, C = cofactors(F);
  double determinant = X.col(0).dot(C.col(0));
  if (!(determinant > kFlattest * size * std::sqrt(size))) return std::nullopt;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Mat3 next = 0.5 * (X + C / determinant);
    const double change = (next - X).norm();
    X = next;
    if (change <= kLastStep) return X;
    C = cofactors(X);
    determinant = X.col(0).dot(C.col(0));
  }
  return std::nullopt;
}

}  // namespace coxa::fem
