#include <coxa/segment/random_walker.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>

namespace coxa::segment {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// What a voxel's equation has on its diagonal: all its links and all priors' pull.
VecX diagonal(const WalkGraph& graph, const std::vector<WalkPrior>& priors,
              const WalkOptions& options) {
  VecX sum = VecX::Constant(static_cast<Index>(graph.next.size()),
                            options.prior_weight * options.other_share);
  for (const WalkPrior& prior : priors) {
    for (std::size_t i = 0; i < prior.voxels.size(); ++i)
      sum[prior.voxels[i]] += options.prior_weight * prior.share[i];
  }
  for (std::size_t v = 0; v < graph.next.size(); ++v) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (graph.next[v][a] < 0) continue;
      sum[static_cast<Index>(v)] += graph.weight[v][a];
      sum[graph.next[v][a]] += graph.weight[v][a];
    }
  }
  return sum;
}

/// The equations of the voxels that may get a label; elsewhere it is 0.
Matrix equations(const WalkGraph& graph, const VecX& diagonal, const WalkPrior& prior) {
  std::vector<Index> local(graph.next.size(), -1);
  for (std::size_t i = 0; i < prior.voxels.size(); ++i)
    local[static_cast<std::size_t>(prior.voxels[i])] = static_cast<Index>(i);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(7 * prior.voxels.size());
  for (std::size_t i = 0; i < prior.voxels.size(); ++i) {
    const auto v = static_cast<std::size_t>(prior.voxels[i]);
    const auto row = static_cast<Index>(i);
    entries.emplace_back(row, row, diagonal[prior.voxels[i]]);
    for (std::size_t a = 0; a < 3; ++a) {
      const Index other = graph.next[v][a];
      if (other < 0) continue;
      const Index column = local[static_cast<std::size_t>(other)];
      if (column < 0) continue;
      entries.emplace_back(row, column, -graph.weight[v][a]);
      entries.emplace_back(column, row, -graph.weight[v][a]);
    }
  }
  const auto n = static_cast<Index>(prior.voxels.size());
  Matrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

VecX shares_of_walks(const WalkGraph& graph, const VecX& diagonal, const WalkPrior& prior,
                     const WalkOptions& options) {
  const Matrix matrix = equations(graph, diagonal, prior);
  VecX pull(static_cast<Index>(prior.share.size()));
  for (Index i = 0; i < pull.size(); ++i)
    pull[i] = options.prior_weight * prior.share[static_cast<std::size_t>(i)];
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper> solver;
  solver.setTolerance(options.tolerance);
  solver.setMaxIterations(options.iterations);
  solver.compute(matrix);
  return solver.solve(pull);
}

}  // namespace

std::vector<int> likeliest_labels(const WalkGraph& graph, const std::vector<WalkPrior>& priors,
                                  const WalkOptions& options, const Monitor& monitor) {
  require(options.prior_weight > 0.0 && options.other_share > 0.0 && options.tolerance > 0.0 &&
              options.iterations >= 1,
          "prior_weight, other_share, tolerance and iterations of a random walk must be positive");
  const VecX sums = diagonal(graph, priors, options);
  std::vector<VecX> found(priors.size());
  parallel_for(static_cast<Index>(priors.size()), [&](Index k) {
    monitor.check_cancelled();
    const auto label = static_cast<std::size_t>(k);
    if (!priors[label].voxels.empty())
      found[label] = shares_of_walks(graph, sums, priors[label], options);
  });
  const std::size_t n = graph.next.size();
  std::vector<int> likeliest(n, -1);
  std::vector<double> best(n, 0.0), rest(n, 1.0);
  for (std::size_t label = 0; label < priors.size(); ++label) {
    for (std::size_t i = 0; i < priors[label].voxels.size(); ++i) {
      const auto v = static_cast<std::size_t>(priors[label].voxels[i]);
      const double share = found[label][static_cast<Index>(i)];
      rest[v] -= share;
      if (share <= best[v]) continue;
      best[v] = share;
      likeliest[v] = static_cast<int>(label);
    }
  }
  for (std::size_t v = 0; v < n; ++v)
    if (rest[v] > best[v]) likeliest[v] = -1;
  return likeliest;
}

}  // namespace coxa::segment
