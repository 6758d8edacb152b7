#include <coxa/fem/signed_svd.h>

#include <Eigen/Geometry>

#include <cmath>
#include <utility>

namespace coxa::fem {
namespace {

constexpr int kMaxSweeps = 12;
constexpr double kOrthogonal = 1e-15;  // cosine between two columns that counts as none

/// Turns columns p and q of B (and of V) until they are orthogonal; false if they were already.
bool orthogonalise(Mat3& B, Mat3& V, int p, int q) {
  const double a = B.col(p).squaredNorm(), b = B.col(q).squaredNorm(), c = B.col(p).dot(B.col(q));
  if (!(c * c > kOrthogonal * kOrthogonal * a * b)) return false;
  const double zeta = (b - a) / (2.0 * c);
  const double t = (zeta >= 0.0 ? 1.0 : -1.0) / (std::abs(zeta) + std::sqrt(1.0 + zeta * zeta));
  const double cosine = 1.0 / std::sqrt(1.0 + t * t), sine = cosine * t;
  for (Mat3* M : {&B, &V}) {
    const Vec3 old_p = M->col(p);
    M->col(p) = cosine * old_p - sine * M->col(q);
    M->col(q) = sine * old_p + cosine * M->col(q);
  }
  return true;
}

/// Exchanges two columns and turns one about, so that V stays a rotation.
void exchange(Mat3& B, Mat3& V, int p, int q) {
  for (Mat3* M : {&B, &V}) {
    const Vec3 old_p = M->col(p);
    M->col(p) = M->col(q);
    M->col(q) = -old_p;
  }
}

}  // namespace

SignedSvd signed_svd(const Mat3& F) {
  Mat3 B = F, V = Mat3::Identity();
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    const bool a = orthogonalise(B, V, 0, 1), b = orthogonalise(B, V, 0, 2);
    const bool c = orthogonalise(B, V, 1, 2);
    if (!a && !b && !c) break;
  }
  Vec3 length = B.colwise().norm().transpose();
  const auto order = [&](int p, int q) {
    if (length[p] >= length[q]) return;
    exchange(B, V, p, q);
    std::swap(length[p], length[q]);
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);

  // the largest directions come from B, the others complete a rotation
  const double tiny = 1e-14 * length[0];
  const Vec3 u0 = length[0] > 0.0 ? Vec3(B.col(0) / length[0]) : Vec3::UnitX();
  Vec3 u1 = length[1] > tiny ? Vec3(B.col(1) / length[1]) : u0.unitOrthogonal();
  u1 = (u1 - u0 * u0.dot(u1)).normalized();
  SignedSvd svd;
  svd.U << u0, u1, u0.cross(u1);
  svd.V = V;
  svd.stretch = Vec3(length[0], length[1], svd.U.col(2).dot(B.col(2)));
  return svd;
}

}  // namespace coxa::fem
