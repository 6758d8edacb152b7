#include "bone_border.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/unfold.h>
#include <coxa/mesh/vertex_normals.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "border_rays.h"
#include "coverage_rays.h"

namespace coxa::segment {
namespace {

// a vertex nearer than this to a layer is covered, mm
constexpr double kCovered = 1.0;
// the cortex's thickness and the surface's error change by so much from a vertex to the next, mm
constexpr double kThicknessChange = 0.15, kBorderChange = 0.3;
// the surface is this near to the border before, mm
constexpr double kBefore = 1.0;
// no single place is known better than this, mm
constexpr double kLeastDeviation = 0.15;
// the middle one of the bands so far around is a place's, mm
constexpr double kBeside = 6.0;
// the thin ones among all so far around are cortex alone, mm and share
constexpr double kAround = 20.0, kThinShare = 0.25;
// a band wider than the cortex around by so much has something dark on it, mm
constexpr double kDarkCover = 0.8;
// what is known of the cortex's thickness at a place from around, mm
constexpr double kKnownThickness = 0.3;
// mean squared residual beyond which a profile is something else
constexpr double kLargestMisfit = 4.0;
// a dark band thinner than this, mm, is none
constexpr double kLeastBand = 0.45;
// what a layer covers stays where it is, more or less, mm
constexpr double kStays = 0.5;
constexpr int kRounds = 4;

/// Values per vertex that are near those measured, by weight, and change little from a vertex to
/// the next. @param stiffness 1 / variance of the change   @param anchor weight of `before`
VecX smooth_values(const Adjacency& neighbours, const VecX& values, const VecX& weight,
                   double stiffness, double anchor, const VecX& before) {
  const Index n = neighbours.size();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index v = 0; v < n; ++v) {
    const auto around = neighbours[v];
    entries.emplace_back(v, v, weight[v] + anchor + stiffness * static_cast<double>(around.size()));
    for (const Index w : around) entries.emplace_back(v, w, -stiffness);
  }
  Eigen::SparseMatrix<double> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  const VecX right = weight.cwiseProduct(values) + anchor * before;
  return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(A).solve(right);
}

/// The value at a share of those around every vertex, on its face of the bone; NaN where none is
/// known.
VecX quantile_around(const TriMesh& bone, const Points& normals, const VecX& values,
                     const VecX& weight, double reach, double share) {
  VecX found(values.size());
  parallel_for(values.size(), [&](Index v) {
    std::vector<double> around;
    for (Index w = 0; w < values.size(); ++w) {
      if (weight[w] > 0.0 && normals.row(v).dot(normals.row(w)) > 0.0 &&
          (bone.points.row(v) - bone.points.row(w)).squaredNorm() < reach * reach)
        around.push_back(values[w]);
    }
    found[v] = around.empty() ? kNaN : quantile(std::move(around), share);
  });
  return found;
}

double weight_of(const BorderFit& fit, double deviation) {
  if (fit.misfit > kLargestMisfit || fit.band < kLeastBand) return 0.0;
  return 1.0 / (deviation * deviation + kLeastDeviation * kLeastDeviation);
}

/// Widths of a bone's dark bands, evened, and of the cortex alone, mm; NaN where nothing is known.
struct Bands {
  VecX width, cortex;
  bool has_dark_cover(Index v) const { return width[v] > cortex[v] + kDarkCover; }
};

/// The cortex is as wide as the dark bands, but where these are much wider than around, as around.
Bands bands_of(const TriMesh& bone, const Points& normals, const Adjacency& neighbours,
               const std::vector<BorderRay>& rays) {
  const Index n = bone.n_vertices();
  VecX band = VecX::Zero(n), weight = VecX::Zero(n);
  for (const BorderRay& ray : rays) {
    band[ray.vertex] = ray.fit.band;
    weight[ray.vertex] = weight_of(ray.fit, ray.fit.band_deviation);
  }
  constexpr double kHold = 1e-6, kStiffness = 1.0 / (kThicknessChange * kThicknessChange);
  const auto evened = [&](const VecX& weights) {
    return smooth_values(neighbours, band, weights, kStiffness, kHold, VecX::Ones(n));
  };
  Bands bands;
  bands.width = quantile_around(bone, normals, band, weight, kBeside, 0.5);
  bands.cortex = quantile_around(bone, normals, band, weight, kAround, kThinShare);
  for (int round = 0; round < kRounds; ++round) {
    VecX bare = weight;
    for (Index v = 0; v < n; ++v) {
      if (!(bands.width[v] < bands.cortex[v] + kDarkCover)) bare[v] = 0.0;
    }
    if (bare.maxCoeff() <= 0.0) return {bands.width, VecX::Constant(n, kNaN)};
    bands.cortex = evened(bare);
  }
  return bands;
}

/// Deviations of the border by the weights of a vertex and its neighbours.
VecX border_deviations(const Adjacency& neighbours, const VecX& weight) {
  VecX deviation(weight.size());
  for (Index v = 0; v < neighbours.size(); ++v) {
    double sum = weight[v];
    for (const Index w : neighbours[v]) sum += weight[w];
    const double mean = sum / (static_cast<double>(neighbours[v].size()) + 1.0);
    deviation[v] = 1.0 / std::sqrt(mean + 1.0 / (kUnknownBorder * kUnknownBorder));
  }
  return deviation;
}

std::vector<bool> covered_vertices(const BareBone& bare) {
  std::vector<bool> covered(static_cast<std::size_t>(bare.bone->n_vertices()), false);
  for (const TriMesh* layer : bare.layers) {
    const TriangleTree tree(layer->points, layer->triangles);
    for (Index v = 0; v < bare.bone->n_vertices(); ++v) {
      if (tree.nearest_within(bare.bone->points.row(v).transpose(), kCovered))
        covered[static_cast<std::size_t>(v)] = true;
    }
  }
  return covered;
}

void update_border(BareBone& bare, std::vector<BorderRay>& rays, const BorderModels& models) {
  TriMesh& bone = *bare.bone;
  const Points normals = vertex_normals(bone);
  const Adjacency neighbours = vertex_neighbours(bone);
  const Bands bands = bands_of(bone, normals, neighbours, rays);
  const std::vector<bool> covered = covered_vertices(bare);
  VecX found = VecX::Zero(bone.n_vertices()), weight = VecX::Zero(bone.n_vertices());
  parallel_for(static_cast<std::int64_t>(rays.size()), [&](Index i) {
    BorderRay& ray = rays[static_cast<std::size_t>(i)];
    const Index v = ray.vertex;
    if (covered[static_cast<std::size_t>(v)] || std::isnan(bands.cortex[v])) return;
    ray.fit = models.fit(ray, {bands.cortex[v], kKnownThickness});
    const bool dark_cover = bands.has_dark_cover(v);
    found[v] = dark_cover ? ray.fit.inner + bands.cortex[v] : ray.fit.outer;
    const double deviation =
        dark_cover ? std::hypot(ray.fit.inner_deviation, kKnownThickness) : ray.fit.outer_deviation;
    weight[v] = weight_of(ray.fit, deviation);
  });
  for (Index v = 0; v < bone.n_vertices(); ++v) {
    if (covered[static_cast<std::size_t>(v)]) weight[v] = 1.0 / (kStays * kStays);
  }
  const VecX move = smooth_values(neighbours, found, weight, 1.0 / (kBorderChange * kBorderChange),
                                  1.0 / (kBefore * kBefore), VecX::Zero(bone.n_vertices()));
  bare.deviation = border_deviations(neighbours, weight);
  bone.points += move.asDiagonal() * normals;
  update_unfolded(bone);
}

}  // namespace

std::vector<double> update_borders(std::vector<BareBone>& bones,
                                   std::span<const PreparedImage> images) {
  std::vector<std::vector<BorderRay>> rays;
  for (const BareBone& bare : bones) rays.push_back(border_rays(*bare.bone, images));
  const BorderModels models = fitted_models(rays, images.size());
  for (BareBone& bare : bones)
    bare.deviation = VecX::Constant(bare.bone->n_vertices(), kUnknownBorder);
  for (std::size_t b = 0; b < bones.size(); ++b) update_border(bones[b], rays[b], models);
  std::vector<double> blur;
  for (std::size_t i = 0; i < images.size(); ++i) blur.push_back(models.blur_share(i));
  return blur;
}

}  // namespace coxa::segment
