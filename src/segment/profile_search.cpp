#include <coxa/segment/profile_search.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "profile_correlation.h"

namespace coxa::segment {
namespace {

/// Standard deviation, as a share of the image's intensity range, below which a profile counts as
/// flat: about twice the noise of a clinical image, so that noise alone correlates with nothing.
constexpr double kFlatShare = 0.03;
/// mm². Variance by which 0.8 mm voxels blur a profile: the references were learned at about that.
constexpr double kTrainedVariance = 0.16;
/// A step of this share of the intensity range over two samples counts as a full border.
constexpr double kFullStep = 0.35;
/// Kinds with a smaller share about a vertex are not expected there.
constexpr double kCommonShare = 0.15;

/// Blur along the normal: a box of one voxel and its linear interpolation, variance spacing²/4 per
/// axis.
double blur_sigma(const Volume& volume, const Vec3& normal, double image_sigma) {
  const Vec3 along = (volume.direction.transpose() * normal).cwiseProduct(volume.spacing);
  const double voxel = 0.25 * along.squaredNorm();
  return std::sqrt(image_sigma * image_sigma + std::max(0.0, voxel - kTrainedVariance));
}

/// Gaussian smoothing of a short profile, weights renormalised at its ends.
VecX smoothed_profile(const VecX& profile, double sigma_samples) {
  if (sigma_samples < 0.2) return profile;
  const Index n = static_cast<Index>(profile.size());
  VecX weight(n);  // by distance in samples
  for (Index d = 0; d < n; ++d) {
    const double t = d / sigma_samples;
    weight[d] = std::exp(-0.5 * t * t);
  }
  VecX out(n);
  for (Index i = 0; i < n; ++i) {
    double sum = 0.0, total = 0.0;
    for (Index j = 0; j < n; ++j) {
      const double w = weight[std::abs(i - j)];
      sum += w * profile[j];
      total += w;
    }
    out[i] = sum / total;
  }
  return out;
}

/// Samples along the normal from -n_before to +n_after steps.
VecX sample_line(const Volume& volume, const Vec3& start, const Vec3& normal, double step,
                 Index n_before, Index n_after) {
  VecX samples(n_before + n_after + 1);
  for (Index j = -n_before; j <= n_after; ++j) {
    samples[n_before + j] = sample(volume, start + (j * step) * normal);
  }
  return samples;
}

/// Scores of one reference at all shifts of vertex v; the better of these and those there are.
void update_with(const ProfileReference& r, const VecX& line, double intensity_range,
                 Index n_inside, const ProfileSearch& search, Index v, ProfileScores& scores) {
  const Index R = scores.n_each_way, last = static_cast<Index>(line.size()) - 1;
  const VecX at_shift = correlations(r, line, kFlatShare * intensity_range);
  for (Index s = 0; s <= 2 * R; ++s) {
    const double c = at_shift[s];
    const Index centre = s + n_inside;
    if (std::isnan(c) || std::isnan(line[centre])) continue;
    const double step = (line[std::min(last, centre + 1)] - line[std::max<Index>(0, centre - 1)]) /
                        (kFullStep * intensity_range);
    const double border = std::isnan(step) ? 0.0 : r.slope * std::clamp(step, -1.0, 1.0);
    const double relative = R > 0 ? (s - R) / static_cast<double>(R) : 0.0;
    const double score =
        c + search.gradient_weight * border - search.shift_penalty * relative * relative;
    if (score <= scores.score(v, s)) continue;  // false where there is none yet
    scores.score(v, s) = score;
    scores.correlation(v, s) = c;
  }
}

/// Place of the largest value of three equally spaced ones relative to the middle, in steps.
double parabola_offset(double before, double middle, double after) {
  const double bend = before - 2.0 * middle + after;
  if (!(bend < -1e-12)) return 0.0;
  return std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
}

/// Weighted mean of four rows.
Eigen::RowVectorXd whole_mean(const ScoreTable& scores, const std::array<Index, 4>& rows,
                              const VecX& weight) {
  const auto [a, b, c, d] = rows;
  const double total = weight[a] + weight[b] + weight[c] + weight[d];
  return (weight[a] * scores.row(a) + weight[b] * scores.row(b) + weight[c] * scores.row(c) +
          weight[d] * scores.row(d)) /
         total;
}

/// The same of what is there of them; missing where the first row is.
Eigen::RowVectorXd mean_of_seen(const ScoreTable& scores, const std::array<Index, 4>& rows,
                                const VecX& weight) {
  Eigen::RowVectorXd mean = scores.row(rows[0]);
  for (Eigen::Index s = 0; s < mean.size(); ++s) {
    if (std::isnan(mean[s])) continue;
    double sum = 0.0, total = 0.0;
    for (const Index u : rows) {
      if (std::isnan(scores(u, s))) continue;
      sum += weight[u] * scores(u, s);
      total += weight[u];
    }
    mean[s] = sum / total;
  }
  return mean;
}

}  // namespace

ProfileScores score_profiles(const PreparedImage& image, const Points& positions,
                             const Points& normals, const shape::ProfileSet& reference,
                             const ProfileSearch& search, const ProfileKinds* kinds) {
  const Index n_profile = static_cast<Index>(reference.mean.cols());
  const Index n_outside = n_profile - 1 - reference.n_inside;
  ProfileScores scores;
  scores.step = reference.step;
  scores.n_each_way = static_cast<Index>(std::ceil(search.range / reference.step));
  const Index R = scores.n_each_way, V = static_cast<Index>(positions.rows());
  scores.score = ScoreTable::Constant(V, 2 * R + 1, kNaN);
  scores.correlation = scores.score;

  parallel_for(V, [&](Index v) {
    const Vec3 normal = normals.row(v).transpose();
    const VecX line = sample_line(image.volume, positions.row(v).transpose(), normal, scores.step,
                                  reference.n_inside + R, n_outside + R);
    const double sigma = blur_sigma(image.volume, normal, search.image_sigma) / scores.step;
    const auto score_one = [&](const VecX& profile) {
      const ProfileReference r = make_reference(smoothed_profile(profile, sigma),
                                                reference.n_inside, scores.step, search.window);
      if (r.informative)
        update_with(r, line, image.intensity_range, reference.n_inside, search, v, scores);
    };
    if (!kinds) {
      score_one(reference.mean.row(v).transpose());
      return;
    }
    const double common = std::min(kCommonShare, kinds->share.row(v).maxCoeff());
    for (Eigen::Index k = 0; k < kinds->mean.rows(); ++k) {
      if (kinds->share(v, k) >= common) score_one(kinds->mean.row(k).transpose());
    }
  });
  return scores;
}

void update_combined(ProfileScores& scores, const ProfileScores& other) {
  COXA_ASSERT(scores.score.rows() == other.score.rows() &&
              scores.score.cols() == other.score.cols());
  for (Eigen::Index i = 0; i < scores.score.size(); ++i) {
    const double a = scores.score.data()[i], b = other.score.data()[i];
    if (std::isnan(b)) continue;
    const double share = std::isnan(a) ? 0.0 : 0.5;
    double& c = scores.correlation.data()[i];
    scores.score.data()[i] = share > 0.0 ? share * (a + b) : b;
    c = share > 0.0 ? share * (c + other.correlation.data()[i]) : other.correlation.data()[i];
  }
}

void update_smoothed(ProfileScores& scores, const Triangles& neighbours, const VecX& reliability,
                     int passes) {
  constexpr double kLeastWeight = 1e-3;
  const VecX weight = reliability.array() + kLeastWeight;
  const auto V = static_cast<Index>(scores.score.rows());
  std::vector<char> whole(static_cast<std::size_t>(V));  // no score of the vertex is missing
  parallel_for(
      V, [&](Index v) { whole[static_cast<std::size_t>(v)] = !scores.score.row(v).hasNaN(); });
  ScoreTable previous(scores.score.rows(), scores.score.cols());
  for (int pass = 0; pass < passes; ++pass) {
    previous.swap(scores.score);
    parallel_for(V, [&](Index v) {
      const std::array<Index, 4> around{v, neighbours(v, 0), neighbours(v, 1), neighbours(v, 2)};
      const bool all = std::all_of(around.begin(), around.end(), [&](Index u) {
        return whole[static_cast<std::size_t>(u)] != 0;
      });
      scores.score.row(v) =
          all ? whole_mean(previous, around, weight) : mean_of_seen(previous, around, weight);
    });
  }
}

ProfileMatch best_match(const ProfileScores& scores, const VecX& reliability) {
  const Index V = static_cast<Index>(scores.score.rows());
  const Index columns = static_cast<Index>(scores.score.cols());
  const Index apart = std::max<Index>(2, static_cast<Index>(std::lround(1.5 / scores.step)));
  const VecX none = VecX::Zero(V);
  ProfileMatch match{none, none, none, none, none};
  parallel_for(V, [&](Index v) {
    const auto row = scores.score.row(v);
    match.seen[v] = std::isnan(row[scores.n_each_way]) ? 0.0 : 1.0;
    Index best = columns;
    for (Index s = 0; s < columns; ++s) {
      if (!std::isnan(row[s]) && (best == columns || row[s] > row[best])) best = s;
    }
    if (best == columns || match.seen[v] == 0.0) return;
    // how far the best stands above every match somewhere else
    double rival = -1.0;
    for (Index s = 0; s < columns; ++s) {
      if (std::abs(s - best) >= apart && !std::isnan(row[s])) rival = std::max(rival, row[s]);
    }
    const double distinct = std::clamp((row[best] - rival) / 0.3, 0.0, 1.0);
    const bool at_end = best == 0 || best == columns - 1;
    double offset = 0.0;
    if (!at_end && !std::isnan(row[best - 1]) && !std::isnan(row[best + 1])) {
      offset = parabola_offset(row[best - 1], row[best], row[best + 1]);
    }
    match.shift[v] = (best - scores.n_each_way + offset) * scores.step;
    match.correlation[v] = scores.correlation(v, best);
    match.here[v] = scores.correlation(v, scores.n_each_way);
    match.confidence[v] = std::clamp(match.correlation[v], 0.0, 1.0) * reliability[v] *
                          (0.3 + 0.7 * distinct) * (at_end && columns > 1 ? 0.3 : 1.0);
  });
  return match;
}

}  // namespace coxa::segment
