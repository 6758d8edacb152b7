#include <coxa/segment/smooth_modes.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <vector>

namespace coxa::segment {
namespace {

/// Distance of the supporting points as a share of the length: nearer ones add nothing.
constexpr double kSpacing = 0.8;
constexpr std::size_t kMostSupports = 160;
/// Modes with less of the variance than this share of the first's are left out.
constexpr double kLeastShare = 1e-3;

/// Vertices farthest from each other, the first vertex first, until all are within `spacing`.
std::vector<Index> spread_vertices(const Points& points, double spacing) {
  std::vector<Index> chosen = {0};
  VecX squared = (points.rowwise() - points.row(0)).rowwise().squaredNorm();
  while (chosen.size() < kMostSupports) {
    Index farthest = 0;
    if (squared.maxCoeff(&farthest) < spacing * spacing) break;
    chosen.push_back(farthest);
    squared =
        squared.cwiseMin((points.rowwise() - points.row(farthest)).rowwise().squaredNorm().eval());
  }
  return chosen;
}

}  // namespace

SmoothModes smooth_modes(const Points& points, const SmoothOptions& options) {
  require(options.deviation >= 0.0 && options.length > 0.0,
          "a smooth deformation needs a deviation of at least 0 and a positive length, got ",
          options.deviation, " and ", options.length, " mm");
  const std::vector<Index> supports = spread_vertices(points, kSpacing * options.length);
  const auto m = static_cast<Index>(supports.size());
  const double variance = options.deviation * options.deviation;
  MatX covariance(points.rows(), m);
  parallel_for(points.rows(), [&](Index v) {
    for (Index s = 0; s < m; ++s) {
      const Index u = supports[static_cast<std::size_t>(s)];
      const double squared = (points.row(v) - points.row(u)).squaredNorm();
      covariance(v, s) = variance * std::exp(-0.5 * squared / (options.length * options.length));
    }
  });
  const MatX among = covariance(supports, Eigen::all);
  const Eigen::SelfAdjointEigenSolver<MatX> solver(among);
  const VecX values = solver.eigenvalues();
  Index n_kept = 0;
  while (n_kept < m && values[m - 1 - n_kept] > kLeastShare * values[m - 1]) ++n_kept;
  const MatX kept = solver.eigenvectors().rightCols(n_kept);
  return {covariance * (kept * values.tail(n_kept).cwiseSqrt().cwiseInverse().asDiagonal())};
}

SmoothModes joined(const SmoothModes& a, const SmoothModes& b) {
  SmoothModes both{MatX(a.moves.rows(), a.moves.cols() + b.moves.cols())};
  both.moves << a.moves, b.moves;
  return both;
}

}  // namespace coxa::segment
