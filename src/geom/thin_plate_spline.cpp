#include <coxa/geom/thin_plate_spline.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <Eigen/Dense>

namespace coxa {

ThinPlateSpline::ThinPlateSpline(const Points& from, const Points& to, double smoothness)
    : from_(from) {
  const Eigen::Index n = from.rows();
  require(n >= 4, "a thin-plate spline needs at least four landmarks, got ", n);
  require(to.rows() == n, "thin-plate spline: ", n, " landmarks against ", to.rows());
  require(from.allFinite() && to.allFinite(), "thin-plate spline: a landmark is not finite");
  require(smoothness >= 0.0, "smoothness must not be negative, got ", smoothness, " mm");
  const Vec3 mean = from.colwise().mean().transpose();
  const Points centred = from.rowwise() - mean.transpose();
  const Vec3 spread = Eigen::JacobiSVD<MatX>(centred).singularValues();
  require(spread[2] > 1e-9 * spread[0], "thin-plate spline: the landmarks lie in a plane");

  MatX system = MatX::Zero(n + 4, n + 4);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const double r = (from.row(i) - from.row(j)).norm();
      require(r > 1e-12 * spread[0], "thin-plate spline: landmarks ", j, " and ", i, " coincide");
      system(i, j) = system(j, i) = r;
    }
  // U(r) = r is conditionally negative definite: smoothing subtracts
  system.diagonal().head(n).setConstant(-smoothness);
  system.block(0, n, n, 3) = from;
  system.block(0, n + 3, n, 1).setOnes();
  system.block(n, 0, 4, n) = system.block(0, n, n, 4).transpose();
  MatX values = MatX::Zero(n + 4, 3);
  values.topRows(n) = to;
  weights_ = system.partialPivLu().solve(values);
}

Vec3 ThinPlateSpline::operator()(const Vec3& x) const {
  const Eigen::Index n = from_.rows();
  Vec3 y = weights_.middleRows<3>(n).transpose() * x + weights_.row(n + 3).transpose();
  for (Eigen::Index i = 0; i < n; ++i)
    y += (x - from_.row(i).transpose()).norm() * weights_.row(i).transpose();
  return y;
}

Points ThinPlateSpline::operator()(const Points& x) const {
  Points y(x.rows(), 3);
  parallel_for(x.rows(), [&](Index i) { y.row(i) = (*this)(Vec3(x.row(i))); });
  return y;
}

}  // namespace coxa
