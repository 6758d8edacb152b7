#include <coxa/segment/profile_kinds.h>

#include <coxa/core/parallel.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace coxa::segment {
namespace {

constexpr Index kKinds = 8;
constexpr int kRounds = 12;
/// mm. Gaussian extent over which samples count when profiles are compared.
constexpr double kWindow = 3.0;
/// The next centre is the profile this far up the order of distances from all centres before: the
/// farthest of all would be an odd one.
constexpr double kFarShare = 0.97;
/// Passes over neighbours that spread where a kind occurs: about six vertices to every side.
constexpr int kSpreadPasses = 40;

MatX windowed(const shape::ProfileSet& set) {
  VecX window(set.mean.cols());
  for (Eigen::Index k = 0; k < window.size(); ++k) {
    const double t = static_cast<double>(k - set.n_inside) * set.step / kWindow;
    window[k] = std::exp(-0.25 * t * t);
  }
  return set.mean * window.asDiagonal();
}

MatX first_centres(const MatX& rows, Index n) {
  MatX centres(n, rows.cols());
  centres.row(0) = rows.colwise().mean();
  VecX squared = (rows.rowwise() - centres.row(0)).rowwise().squaredNorm();
  std::vector<Index> order(static_cast<std::size_t>(rows.rows()));
  for (Index c = 1; c < n; ++c) {
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Index>(i);
    const auto far = order.begin() + static_cast<std::ptrdiff_t>(kFarShare * (rows.rows() - 1));
    std::nth_element(order.begin(), far, order.end(), [&](Index a, Index b) {
      return squared[a] != squared[b] ? squared[a] < squared[b] : a < b;
    });
    centres.row(c) = rows.row(*far);
    squared = squared.cwiseMin((rows.rowwise() - centres.row(c)).rowwise().squaredNorm().eval());
  }
  return centres;
}

/// Means of the rows of each label; a label without rows keeps its row of `otherwise`.
MatX means_of(const MatX& rows, const std::vector<Index>& labels, const MatX& otherwise) {
  MatX sum = MatX::Zero(otherwise.rows(), rows.cols());
  VecX count = VecX::Zero(otherwise.rows());
  for (Eigen::Index v = 0; v < rows.rows(); ++v) {
    const Index label = labels[static_cast<std::size_t>(v)];
    sum.row(label) += rows.row(v);
    count[label] += 1.0;
  }
  for (Eigen::Index k = 0; k < sum.rows(); ++k) {
    if (count[k] > 0.0)
      sum.row(k) /= count[k];
    else
      sum.row(k) = otherwise.row(k);
  }
  return sum;
}

}  // namespace

ProfileKinds profile_kinds(const shape::ProfileSet& set, const Triangles& neighbours) {
  const auto V = static_cast<Index>(set.mean.rows());
  const Index n = std::min(kKinds, V);
  const MatX rows = windowed(set);
  MatX centres = first_centres(rows, n);
  std::vector<Index> labels(static_cast<std::size_t>(V), 0);
  for (int round = 0; round < kRounds; ++round) {
    parallel_for(V, [&](Index v) {
      (centres.rowwise() - rows.row(v))
          .rowwise()
          .squaredNorm()
          .minCoeff(&labels[static_cast<std::size_t>(v)]);
    });
    centres = means_of(rows, labels, centres);
  }
  ProfileKinds kinds{means_of(set.mean, labels, MatX::Zero(n, set.mean.cols())), MatX::Zero(V, n)};
  for (Index v = 0; v < V; ++v) kinds.share(v, labels[static_cast<std::size_t>(v)]) = 1.0;
  for (int pass = 0; pass < kSpreadPasses; ++pass) {
    const MatX before = kinds.share;
    parallel_for(V, [&](Index v) {
      kinds.share.row(v) = 0.25 * (before.row(v) + before.row(neighbours(v, 0)) +
                                   before.row(neighbours(v, 1)) + before.row(neighbours(v, 2)));
    });
  }
  return kinds;
}

}  // namespace coxa::segment
