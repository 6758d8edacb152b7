#include <coxa/geom/fits.h>
#include <coxa/geom/median.h>

#include <coxa/core/error.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <vector>

namespace coxa {
namespace {

// smallest over largest singular value below which points count as lying in a plane (or a line)
constexpr double kFlat = 1e-9;

VecX checked_weights(const VecX& weights, Eigen::Index n) {
  if (weights.size() == 0) return VecX::Ones(n);
  require(weights.size() == n, "got ", weights.size(), " weights for ", n, " points");
  require(weights.allFinite() && weights.minCoeff() >= 0.0 && weights.sum() > 0.0,
          "weights must be finite, not negative, and not all zero");
  return weights;
}

Vec3 weighted_mean(const Points& points, const VecX& weights) {
  return points.transpose() * weights / weights.sum();
}

// singular values and right vectors (principal axes) of the centred, weighted points
Eigen::JacobiSVD<MatX> principal_axes(const Points& points, const Vec3& mean, const VecX& weights) {
  const MatX centred = weights.cwiseSqrt().asDiagonal() * (points.rowwise() - mean.transpose());
  return Eigen::JacobiSVD<MatX>(centred, Eigen::ComputeFullV);
}

void require_spread(const Points& points, const VecX& weights, int dimensions, const char* what) {
  require(points.rows() > dimensions, what, " needs at least ", dimensions + 1, " points, got ",
          points.rows());
  require(points.allFinite(), what, ": a point is not finite");
  const VecX spread =
      principal_axes(points, weighted_mean(points, weights), weights).singularValues();
  require(spread[dimensions - 1] > kFlat * spread[0], what, ": the points lie in ",
          dimensions == 3   ? "a plane"
          : dimensions == 2 ? "a line"
                            : "one place");
}

void require_pairs(const Points& a, const Points& b, const char* what) {
  require(a.rows() == b.rows(), what, ": ", a.rows(), " points against ", b.rows());
  require(b.allFinite(), what, ": a point is not finite");
}

// algebraic fit: |p|² = 2 c·p + k is linear in centre and k = radius² - |c|²
Sphere algebraic_sphere(const Points& points, const VecX& weights) {
  const Vec3 mean = weighted_mean(points, weights);
  const Points q = points.rowwise() - mean.transpose();
  const VecX root = weights.cwiseSqrt();
  MatX A(q.rows(), 4);
  A << 2.0 * q, VecX::Ones(q.rows());
  const VecX x = (root.asDiagonal() * A)
                     .colPivHouseholderQr()
                     .solve(root.cwiseProduct(q.rowwise().squaredNorm()));
  const Vec3 c = x.head<3>();
  return {mean + c, std::sqrt(std::max(0.0, x[3] + c.squaredNorm())), 0.0};
}

VecX sphere_residuals(const Points& points, const Sphere& sphere) {
  return (points.rowwise() - sphere.centre.transpose()).rowwise().norm().array() - sphere.radius;
}

Sphere geometric_sphere(const Points& points, const VecX& weights, Sphere sphere) {
  const VecX root = weights.cwiseSqrt();
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Points offset = points.rowwise() - sphere.centre.transpose();
    const VecX distance = offset.rowwise().norm().cwiseMax(1e-12 * sphere.radius + 1e-300);
    MatX jacobian(points.rows(), 4);
    jacobian << -(distance.cwiseInverse().asDiagonal() * offset), -VecX::Ones(points.rows());
    const VecX residual = distance.array() - sphere.radius;
    const VecX step =
        (root.asDiagonal() * jacobian).colPivHouseholderQr().solve(-root.cwiseProduct(residual));
    sphere.centre += step.head<3>();
    sphere.radius += step[3];
    if (step.norm() <= 1e-13 * sphere.radius) break;
  }
  return sphere;
}

}  // namespace

VecX tukey_weights(const VecX& residuals, double outlier_scale) {
  if (outlier_scale == 0.0) return VecX::Ones(residuals.size());
  const double sigma = median(residuals.cwiseAbs()) / 0.6745;
  const double cut = outlier_scale * sigma;
  if (!(cut > 0.0)) return (residuals.array() == 0.0).cast<double>();
  return residuals.unaryExpr([cut](double r) {
    const double u = 1.0 - (r / cut) * (r / cut);
    return u > 0.0 ? u * u : 0.0;
  });
}

Sphere fit_sphere(const Points& points, const VecX& weights, const SphereFitOptions& options) {
  require(options.outlier_scale >= 0.0, "outlier_scale must not be negative, got ",
          options.outlier_scale);
  const VecX base = checked_weights(weights, points.rows());
  require_spread(points, base, 3, "sphere fit");
  Sphere sphere = geometric_sphere(points, base, algebraic_sphere(points, base));
  VecX used = base;
  if (options.outlier_scale > 0.0) {
    for (int round = 0; round < 50; ++round) {
      const VecX residuals = sphere_residuals(points, sphere);
      const VecX next = base.cwiseProduct(tukey_weights(residuals, options.outlier_scale));
      if (residuals.cwiseAbs().maxCoeff() <= 1e-12 * sphere.radius ||
          (next.array() > 0.0).count() < 4)
        break;
      const Sphere previous = sphere;
      used = next;
      sphere = geometric_sphere(points, used, sphere);
      if ((sphere.centre - previous.centre).norm() <= 1e-12 * sphere.radius) break;
    }
  }
  const VecX residuals = sphere_residuals(points, sphere);
  sphere.rms = std::sqrt(used.dot(residuals.cwiseAbs2()) / used.sum());
  return sphere;
}

Plane fit_plane(const Points& points) {
  const VecX weights = VecX::Ones(points.rows());
  require_spread(points, weights, 2, "plane fit");
  const Vec3 mean = weighted_mean(points, weights);
  return {mean, principal_axes(points, mean, weights).matrixV().col(2)};
}

Line fit_line(const Points& points) {
  const VecX weights = VecX::Ones(points.rows());
  require_spread(points, weights, 1, "line fit");
  const Vec3 mean = weighted_mean(points, weights);
  return {mean, principal_axes(points, mean, weights).matrixV().col(0)};
}

Similarity fit_similarity(const Points& a, const Points& b, const VecX& weights) {
  require_pairs(a, b, "similarity fit");
  const VecX w = checked_weights(weights, a.rows());
  require_spread(a, w, 2, "similarity fit");
  const Vec3 mean_a = weighted_mean(a, w), mean_b = weighted_mean(b, w);
  const Points centred_a = a.rowwise() - mean_a.transpose(),
               centred_b = b.rowwise() - mean_b.transpose();
  const Mat3 covariance = centred_b.transpose() * w.asDiagonal() * centred_a;
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double handedness =
      (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Vec3 signs(1.0, 1.0, handedness);
  Similarity result;
  result.X.R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  result.scale = svd.singularValues().dot(signs) / w.dot(centred_a.rowwise().squaredNorm());
  result.X.p = mean_b - result.scale * (result.X.R * mean_a);
  return result;
}

RigidTransform fit_rigid(const Points& a, const Points& b, const VecX& weights) {
  const Similarity similarity = fit_similarity(a, b, weights);
  const VecX w = checked_weights(weights, a.rows());
  return {similarity.X.R, weighted_mean(b, w) - similarity.X.R * weighted_mean(a, w)};
}

AffineTransform fit_affine(const Points& a, const Points& b, const VecX& weights) {
  require_pairs(a, b, "affine fit");
  const VecX w = checked_weights(weights, a.rows());
  require_spread(a, w, 3, "affine fit");
  const Vec3 mean_a = weighted_mean(a, w), mean_b = weighted_mean(b, w);
  const VecX root = w.cwiseSqrt();
  const MatX left = root.asDiagonal() * (a.rowwise() - mean_a.transpose());
  const MatX right = root.asDiagonal() * (b.rowwise() - mean_b.transpose());
  AffineTransform result;
  result.A = left.colPivHouseholderQr().solve(right).transpose();
  result.t = mean_b - result.A * mean_a;
  return result;
}

}  // namespace coxa
