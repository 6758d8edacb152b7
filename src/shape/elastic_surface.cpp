#include "elastic_surface.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>

namespace coxa::shape {
namespace {

// a piece may not shrink or grow by more than this factor
constexpr double kLargestGrowth = 2.0;
// keeps the matrix regular where nothing pulls, share of a full pull
constexpr double kGround = 1e-6;

using Sparse = Eigen::SparseMatrix<double>;

// GCC 12 at -O3 takes Eigen's fixed-size decomposition for uninitialised
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
/// Rotation and size that best take the columns behind `covariance` (sum of rest · currentᵀ) along.
Mat3 similarity_from(const Mat3& covariance, double rest_square) {
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 U = svd.matrixU(), V = svd.matrixV();
  const Vec3 sigma = svd.singularValues();
  const double last = (V * U.transpose()).determinant() < 0.0 ? -1.0 : 1.0;  // never a reflection
  Mat3 turned = V;
  turned.col(2) *= last;
  const Mat3 R = turned * U.transpose();
  const double size = (sigma[0] + sigma[1] + last * sigma[2]) / rest_square;
  return std::clamp(size, 1.0 / kLargestGrowth, kLargestGrowth) * R;
}
#pragma GCC diagnostic pop

}  // namespace

ElasticSurface::ElasticSurface(const TriMesh& rest)
    : rest_(rest.points), neighbours_(vertex_neighbours(rest)), edge_(mean_edge_length(rest)) {}

std::vector<Mat3> ElasticSurface::local_similarities(const Points& current) const {
  const auto n = static_cast<std::size_t>(rest_.rows());
  std::vector<Mat3> covariance(n), result(n);
  std::vector<double> square(n);
  parallel_for(rest_.rows(), [&](Index v) {
    Mat3 sum = Mat3::Zero();
    double rest_square = 0.0;
    for (const Index w : neighbours_[v]) {
      const Vec3 before = rest_.row(w) - rest_.row(v), now = current.row(w) - current.row(v);
      sum += before * now.transpose();
      rest_square += before.squaredNorm();
    }
    covariance[static_cast<std::size_t>(v)] = sum;
    square[static_cast<std::size_t>(v)] = rest_square;
  });
  // the neighbours count too, so that the surface also resists bending
  parallel_for(rest_.rows(), [&](Index v) {
    Mat3 sum = covariance[static_cast<std::size_t>(v)];
    double rest_square = square[static_cast<std::size_t>(v)];
    for (const Index w : neighbours_[v]) {
      sum += covariance[static_cast<std::size_t>(w)];
      rest_square += square[static_cast<std::size_t>(w)];
    }
    result[static_cast<std::size_t>(v)] = similarity_from(sum, rest_square);
  });
  return result;
}

Points ElasticSurface::relaxed(const Points& current, const Points& targets, const VecX& weights,
                               double length) const {
  const Index n = static_cast<Index>(rest_.rows());
  const double stiffness = (length / edge_) * (length / edge_);
  const std::vector<Mat3> M = local_similarities(current);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(neighbours_.items.size() + static_cast<std::size_t>(n));
  MatX right(n, 3);
  for (Index v = 0; v < n; ++v) {
    const auto around = neighbours_[v];
    Vec3 sum = weights[v] * targets.row(v) + kGround * current.row(v);
    for (const Index w : around) {
      const Vec3 rest_edge = rest_.row(v) - rest_.row(w);
      const auto i = static_cast<std::size_t>(v), j = static_cast<std::size_t>(w);
      sum += stiffness * 0.5 * (M[i] + M[j]) * rest_edge;
      if (w < v) entries.emplace_back(v, w, -stiffness);
    }
    entries.emplace_back(v, v,
                         weights[v] + kGround + stiffness * static_cast<double>(around.size()));
    right.row(v) = sum;
  }
  Sparse A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Sparse, Eigen::Lower> solver(A);
  COXA_ASSERT(solver.info() == Eigen::Success);
  return solver.solve(right);
}

}  // namespace coxa::shape
