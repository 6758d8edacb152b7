#include <coxa/shape/shape_modes.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace coxa::shape {
namespace {

// Procrustes converges in a few rounds; the mean moves by less than a micrometre after ten
constexpr int kProcrustesRounds = 10;

Points mapped(const Points& points, const Similarity& map) {
  return transformed(map.scale * points, map.X);
}

VecX flat(const Points& points) { return Eigen::Map<const VecX>(points.data(), points.size()); }

Points mean_of(const std::vector<Points>& shapes) {
  Points sum = Points::Zero(shapes.front().rows(), 3);
  for (const Points& shape : shapes) sum += shape;
  return sum / static_cast<double>(shapes.size());
}

}  // namespace

AlignedShapes align_shapes(const std::vector<Points>& shapes, const VecX& weights) {
  require(!shapes.empty(), "a shape model needs at least one example");
  for (const Points& shape : shapes) {
    require(shape.rows() == shapes.front().rows(),
            "examples differ in their number of points: ", shape.rows(), " and ",
            shapes.front().rows());
  }
  // the plain mean fixes the average pose and size, each round's mean is put back there
  const Points average = mean_of(shapes);
  AlignedShapes aligned{shapes, shapes.front()};
  aligned.mean = mapped(aligned.mean, fit_similarity(aligned.mean, average, weights));
  for (int round = 0; round < kProcrustesRounds; ++round) {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      aligned.shapes[i] = mapped(shapes[i], fit_similarity(shapes[i], aligned.mean, weights));
    }
    const Points mean = mean_of(aligned.shapes);
    aligned.mean = mapped(mean, fit_similarity(mean, average, weights));
  }
  return aligned;
}

ShapeModes principal_modes(const AlignedShapes& aligned, double variance_share) {
  require(0.0 < variance_share && variance_share <= 1.0, "variance_share must be in (0, 1], got ",
          variance_share);
  const auto n = static_cast<Index>(aligned.shapes.size());
  const Index size = static_cast<Index>(aligned.mean.size());
  if (n < 2) return {MatX::Zero(size, 0), VecX::Zero(0)};
  MatX residuals(size, n);
  for (Index i = 0; i < n; ++i)
    residuals.col(i) = flat(aligned.shapes[static_cast<std::size_t>(i)]) - flat(aligned.mean);
  // the small n×n matrix has the same non-zero eigenvalues as the covariance
  const Eigen::SelfAdjointEigenSolver<MatX> solver(residuals.transpose() * residuals / (n - 1.0));
  const VecX values = solver.eigenvalues().reverse().cwiseMax(0.0);
  const double total = values.sum();
  Index k = 0;
  for (double sum = 0.0; k < n - 1 && sum < variance_share * total; ++k) sum += values[k];
  ShapeModes modes{MatX(size, k), values.head(k).cwiseSqrt()};
  for (Index m = 0; m < k; ++m) {
    VecX mode = residuals * solver.eigenvectors().col(n - 1 - m);
    Index largest = 0;
    mode.cwiseAbs().maxCoeff(&largest);
    modes.modes.col(m) = mode * ((mode[largest] > 0.0 ? 1.0 : -1.0) / mode.norm());  // a fixed sign
  }
  return modes;
}

std::vector<double> leave_one_out_errors(const AlignedShapes& aligned) {
  std::vector<double> errors;
  const std::size_t n = aligned.shapes.size();
  if (n < 3) return errors;
  for (std::size_t left = 0; left < n; ++left) {
    AlignedShapes rest;
    for (std::size_t i = 0; i < n; ++i) {
      if (i != left) rest.shapes.push_back(aligned.shapes[i]);
    }
    rest.mean = mean_of(rest.shapes);
    const Points& shape = aligned.shapes[left];
    const VecX off = flat(mapped(shape, fit_similarity(shape, rest.mean))) - flat(rest.mean);
    const MatX modes = principal_modes(rest, 1.0).modes;
    const VecX missed = off - modes * (modes.transpose() * off);
    errors.push_back(missed.norm() / std::sqrt(static_cast<double>(shape.rows())));
  }
  return errors;
}

Points shape_from(const Points& mean, const ShapeModes& modes, const VecX& coefficients) {
  const auto k = coefficients.size();
  require(k <= modes.deviations.size(), "the model has ", modes.deviations.size(), " modes, ", k,
          " coefficients given");
  const VecX moved = modes.modes.leftCols(k) * coefficients.cwiseProduct(modes.deviations.head(k));
  return mean + Eigen::Map<const Points>(moved.data(), mean.rows(), 3);
}

}  // namespace coxa::shape
