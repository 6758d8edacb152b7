#include "pose_score.h"

#include <coxa/mesh/simplex_mesh.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace coxa::segment {
namespace {

constexpr double kSampleStep = 2.5;  // mm, along the normal
constexpr double kWindow = 5.0;  // mm, Gaussian weight of a sample by its distance to the border
constexpr double kFlatShare =
    0.03;  // of the intensity range: profiles flatter than that say nothing

/// The reference at the offsets, smoothed like the image; its ends go on as they are.
VecX smoothed_at(const VecX& profile, Index n_inside, double step, const VecX& offsets,
                 double sigma) {
  const auto last = static_cast<double>(profile.size() - 1);
  VecX values(offsets.size());
  for (Eigen::Index k = 0; k < offsets.size(); ++k) {
    double sum = 0.0, total = 0.0;
    for (double t = -2.5 * sigma; t <= 2.5 * sigma; t += step) {
      const double at = std::clamp(n_inside + (offsets[k] + t) / step, 0.0, last);
      const double w = std::exp(-0.5 * t * t / (sigma * sigma));
      sum += w * profile[std::lround(at)];
      total += w;
    }
    values[k] = sum / total;
  }
  return values;
}

}  // namespace

PoseScore::PoseScore(const std::vector<const shape::StructureModel*>& bones, const Volume& image,
                     double intensity_range, double smoothing, Index n_probes)
    : image_(image), flat_variance_(std::pow(kFlatShare * intensity_range, 2)) {
  std::set<std::string> names;
  for (const shape::ProfileSet& set : bones.front()->profiles) names.insert(set.contrast);
  contrasts_.assign(names.begin(), names.end());
  const shape::ProfileSet& first = bones.front()->profiles.front();
  const double reach = first.step * first.n_inside;
  const auto each_way = static_cast<Index>(std::floor(reach / kSampleStep + 1e-9));
  offsets_ = VecX::LinSpaced(2 * each_way + 1, -kSampleStep * each_way, kSampleStep * each_way);
  weights_ = (-0.5 * (offsets_ / kWindow).array().square()).exp();
  weights_ /= weights_.sum();

  std::vector<std::pair<std::size_t, Index>> probes;  // bone, vertex
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const Index V = bones[b]->hierarchy.levels.back().n_vertices();
    const Index stride = std::max<Index>(1, V / n_probes);
    for (Index v = 0; v < V; v += stride) probes.emplace_back(b, v);
  }
  const auto n = static_cast<Eigen::Index>(probes.size());
  points_.resize(n, 3);
  normals_.resize(n, 3);
  references_.assign(contrasts_.size(), MatX::Zero(n, offsets_.size()));
  reliabilities_.assign(contrasts_.size(), VecX::Zero(n));
  std::vector<Points> normals;
  for (const auto* bone : bones) normals.push_back(simplex_normals(bone->hierarchy.levels.back()));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto [b, v] = probes[static_cast<std::size_t>(i)];
    points_.row(i) = bones[b]->hierarchy.levels.back().points.row(v);
    normals_.row(i) = normals[b].row(v);
    for (const shape::ProfileSet& set : bones[b]->profiles) {
      const auto c = static_cast<std::size_t>(
          std::find(contrasts_.begin(), contrasts_.end(), set.contrast) - contrasts_.begin());
      if (c == contrasts_.size()) continue;
      VecX r = smoothed_at(set.mean.row(v), set.n_inside, set.step, offsets_, smoothing);
      r.array() -= weights_.dot(r);
      const double variance = weights_.dot(r.cwiseAbs2());
      if (variance < 1e-12) continue;
      references_[c].row(i) = (r / std::sqrt(variance)).cwiseProduct(weights_);
      reliabilities_[c][i] = set.reliability[v];
    }
  }
}

VecX PoseScore::at(const Similarity& pose) const {
  const Eigen::Index n = points_.rows(), m = offsets_.size();
  const auto C = static_cast<Eigen::Index>(contrasts_.size());
  VecX sums = VecX::Zero(C), weights = VecX::Zero(C), all = VecX::Zero(C);
  VecX line(m);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index c = 0; c < C; ++c) all[c] += reliabilities_[static_cast<std::size_t>(c)][i];
    const Vec3 p = pose.X * Vec3(pose.scale * points_.row(i).transpose());
    const Vec3 normal = pose.X.R * normals_.row(i).transpose();
    bool seen = true;
    for (Eigen::Index k = 0; k < m && seen; ++k) {
      line[k] = sample(image_, p + offsets_[k] * normal);
      seen = !std::isnan(line[k]);
    }
    if (!seen) continue;
    const double mean = weights_.dot(line);
    const double variance = weights_.dot((line.array() - mean).square().matrix());
    const double scale = 1.0 / std::sqrt(variance + flat_variance_);
    for (Eigen::Index c = 0; c < C; ++c) {
      const auto k = static_cast<std::size_t>(c);
      sums[c] += reliabilities_[k][i] * scale * references_[k].row(i).dot(line);
      weights[c] += reliabilities_[k][i];
    }
  }
  return sums.cwiseQuotient(weights.cwiseMax(kShareInView * all).cwiseMax(1e-12));
}

}  // namespace coxa::segment
