#include "element_assembly.h"

#include <coxa/core/error.h>

#include <algorithm>
#include <numeric>

#include "element_shape.h"

namespace coxa::fem {
namespace {

using Size = std::size_t;

constexpr Index kMaxTasks = 64;

void check_axes(const std::vector<Mat3>& axes, Index n_elements) {
  require(axes.empty() || static_cast<Index>(axes.size()) == n_elements,
          "material axes are given for ", axes.size(), " of ", n_elements, " elements");
  for (Size e = 0; e < axes.size(); ++e)
    require((axes[e].transpose() * axes[e] - Mat3::Identity()).norm() < 1e-6,
            "the material axes of element ", e, " are not orthonormal");
}

}  // namespace

ElementAssembly::ElementAssembly(const TetMesh& mesh, ParticleMap map,
                                 const std::vector<Mat3>& axes)
    : n_elements_(mesh.n_tets()), n_nodes_(nodes_per_element(mesh)) {
  check_connectivity(mesh);
  check_axes(axes, n_elements_);
  if (map.particle_of.empty()) {
    map.particle_of.resize(static_cast<Size>(mesh.n_vertices()));
    std::iota(map.particle_of.begin(), map.particle_of.end(), Index{0});
  }
  require(static_cast<Index>(map.particle_of.size()) == mesh.n_vertices(), "the particle map has ",
          map.particle_of.size(), " entries for ", mesh.n_vertices(), " nodes");
  offset_ = Points::Zero(mesh.n_vertices(), 3);
  if (map.offset.rows() > 0) set_offsets(map.offset);

  for (Index e = 0; e < n_elements_; ++e) {
    ElementShape shape = element_shape(mesh, e);
    n_points_ = static_cast<int>(shape.weight.size());
    weight_.insert(weight_.end(), shape.weight.begin(), shape.weight.end());
    for (const Vec3& gradient : shape.gradient)
      shape_gradient_.push_back(
          axes.empty() ? gradient : Vec3(axes[static_cast<Size>(e)].transpose() * gradient));
    for (int a = 0; a < n_nodes_; ++a) {
      node_.push_back(element_node(mesh, e, a));
      particle_.push_back(map.particle_of[static_cast<Size>(node_.back())]);
      require(particle_.back() >= 0, "node ", node_.back(), " is tied to particle ",
              particle_.back());
    }
  }
  find_rows(particle_.empty() ? 0 : *std::max_element(particle_.begin(), particle_.end()) + 1);
  find_neighbours();
}

void ElementAssembly::find_rows(Index n_particles) {
  std::vector<std::int64_t> count(static_cast<Size>(n_particles), 0);
  for (const Index p : particle_) ++count[static_cast<Size>(p)];
  std::vector<Size> row_of(static_cast<Size>(n_particles));
  use_start_ = {0};
  for (Index p = 0; p < n_particles; ++p) {
    if (count[static_cast<Size>(p)] == 0) continue;
    row_of[static_cast<Size>(p)] = rows_.size();
    rows_.push_back(p);
    use_start_.push_back(use_start_.back() + count[static_cast<Size>(p)]);
  }
  uses_.resize(particle_.size());
  std::vector<std::int64_t> next(use_start_.begin(), use_start_.end() - 1);
  for (Size k = 0; k < particle_.size(); ++k)
    uses_[static_cast<Size>(next[row_of[static_cast<Size>(particle_[k])]]++)] =
        static_cast<std::int64_t>(k);
}

void ElementAssembly::find_neighbours() {
  const Size n = static_cast<Size>(n_nodes_);
  entry_.resize(particle_.size() * n);
  neighbour_start_ = {0};
  std::vector<Index> found;
  for (Size row = 0; row < rows_.size(); ++row) {
    const auto begin = uses_.begin() + use_start_[row], end = uses_.begin() + use_start_[row + 1];
    found.clear();
    for (auto use = begin; use != end; ++use) {
      const Size first = static_cast<Size>(*use) / n * n;
      found.insert(found.end(), particle_.begin() + static_cast<std::int64_t>(first),
                   particle_.begin() + static_cast<std::int64_t>(first + n));
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    for (auto use = begin; use != end; ++use) {
      const Size first = static_cast<Size>(*use) / n * n;
      for (Size b = 0; b < n; ++b)
        entry_[static_cast<Size>(*use) * n + b] = static_cast<Index>(
            std::lower_bound(found.begin(), found.end(), particle_[first + b]) - found.begin());
    }
    neighbours_.insert(neighbours_.end(), found.begin(), found.end());
    neighbour_start_.push_back(static_cast<std::int64_t>(neighbours_.size()));
  }
}

std::vector<std::pair<Index, Index>> ElementAssembly::pattern() const {
  std::vector<std::pair<Index, Index>> pairs;
  pairs.reserve(neighbours_.size());
  for (Size row = 0; row < rows_.size(); ++row)
    for (auto k = neighbour_start_[row]; k < neighbour_start_[row + 1]; ++k)
      pairs.emplace_back(rows_[row], neighbours_[static_cast<Size>(k)]);
  return pairs;
}

void ElementAssembly::set_offsets(const Points& offset) {
  require(offset.rows() == offset_.rows(), "offsets are given for ", offset.rows(), " of ",
          offset_.rows(), " nodes");
  offset_ = offset;
}

Points ElementAssembly::node_positions(const VecX& x) const {
  Points positions = Points::Constant(offset_.rows(), 3, kNaN);
  for (Size k = 0; k < node_.size(); ++k)
    positions.row(node_[k]) =
        x.segment<3>(3 * Eigen::Index{particle_[k]}).transpose() + offset_.row(node_[k]);
  return positions;
}

void ElementAssembly::add_point_blocks(Index e, int q, const Mat9& C, Mat3* blocks) const {
  for (int b = 0; b < n_nodes_; ++b) {
    // C contracted with the gradient of node b: three 3×3 parts, one for each column of F
    const Vec3& rb = shape_gradient(e, q, b);
    const Eigen::Matrix<double, 9, 3> D =
        C.leftCols<3>() * rb[0] + C.middleCols<3>(3) * rb[1] + C.rightCols<3>() * rb[2];
    for (int a = 0; a <= b; ++a) {
      const Vec3& ra = shape_gradient(e, q, a);
      blocks[block_number(a, b)] +=
          ra[0] * D.topRows<3>() + ra[1] * D.middleRows<3>(3) + ra[2] * D.bottomRows<3>();
    }
  }
}

void ElementAssembly::gather_force(const Vec3* part, VecX& force) const {
  parallel_for(static_cast<std::int64_t>(rows_.size()), [&](Index r) {
    const Size row = static_cast<Size>(r);
    Vec3 sum = Vec3::Zero();
    for (auto k = use_start_[row]; k < use_start_[row + 1]; ++k)
      sum += part[uses_[static_cast<Size>(k)]];
    force.segment<3>(3 * Eigen::Index{rows_[row]}) += sum;
  });
}

void ElementAssembly::gather_blocks(const Mat3* part, solve::BlockMatrix& A) const {
  const auto n_rows = static_cast<std::int64_t>(rows_.size());
  const auto tasks = static_cast<Index>(std::min<std::int64_t>(kMaxTasks, n_rows));
  const Size n = static_cast<Size>(n_nodes_);
  parallel_for(tasks, [&](Index task) {
    std::vector<Mat3> sums;
    for (auto row = static_cast<Size>(n_rows * task / tasks);
         row < static_cast<Size>(n_rows * (task + 1) / tasks); ++row) {
      const auto first = neighbour_start_[row], last = neighbour_start_[row + 1];
      sums.assign(static_cast<Size>(last - first), Mat3::Zero());
      for (auto k = use_start_[row]; k < use_start_[row + 1]; ++k) {
        const Size use = static_cast<Size>(uses_[static_cast<Size>(k)]);
        const int a = static_cast<int>(use % n);
        const Mat3* blocks = part + use / n * static_cast<Size>(n_blocks());
        for (int b = 0; b < n_nodes_; ++b) {
          Mat3& sum = sums[static_cast<Size>(entry_[use * n + static_cast<Size>(b)])];
          if (a <= b)
            sum += blocks[block_number(a, b)];
          else
            sum += blocks[block_number(b, a)].transpose();
        }
      }
      // both lists of columns ascend
      auto slot = A.row_start()[static_cast<Size>(rows_[row])];
      for (auto k = first; k < last; ++k) {
        while (A.columns()[static_cast<Size>(slot)] != neighbours_[static_cast<Size>(k)]) ++slot;
        A.blocks()[static_cast<Size>(slot)] += sums[static_cast<Size>(k - first)];
      }
    }
  });
}

}  // namespace coxa::fem
