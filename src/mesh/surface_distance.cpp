#include <coxa/mesh/surface_distance.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/voxelize.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace coxa {
namespace {

Points judged_samples(const TriMesh& mesh, const SurfaceDistanceOptions& options,
                      std::uint64_t seed) {
  const double wanted = std::max(2000.0, area(mesh) * options.samples_per_mm2);
  const auto n = static_cast<Index>(std::min(wanted, static_cast<double>(options.max_samples)));
  const Points all = sample_surface(mesh, n, seed);
  if (!options.within) return all;
  std::vector<Index> kept;
  for (Index i = 0; i < all.rows(); ++i)
    if (options.within(all.row(i))) kept.push_back(i);
  require(!kept.empty(), "surface_distance: nothing of one surface lies within the region judged");
  return all(kept, Eigen::all);
}

VecX signed_distances(const Points& points, const TriMesh& mesh) {
  const TriangleTree tree(mesh.points, mesh.triangles);
  VecX distances(points.rows());
  parallel_for(points.rows(), [&](Index i) { distances[i] = tree.signed_distance(points.row(i)); });
  return distances;
}

}  // namespace

Points sample_surface(const TriMesh& mesh, Index n, std::uint64_t seed) {
  if (mesh.empty()) fail(ErrorCode::bad_mesh, "sample_surface: the surface has no triangle");
  require(n >= 0, "sample_surface: n must not be negative, got ", n);
  VecX up_to = triangle_areas(mesh);
  for (Index t = 1; t < up_to.size(); ++t) up_to[t] += up_to[t - 1];
  Rng rng(seed);
  Points points(n, 3);
  for (Index i = 0; i < n; ++i) {
    const double* place = std::upper_bound(up_to.data(), up_to.data() + up_to.size() - 1,
                                           rng.uniform() * up_to[up_to.size() - 1]);
    const auto t = static_cast<Index>(place - up_to.data());
    double u = rng.uniform(), v = rng.uniform();
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    const auto corner = [&](int k) { return mesh.points.row(mesh.triangles(t, k)); };
    points.row(i) = (1.0 - u - v) * corner(0) + u * corner(1) + v * corner(2);
  }
  return points;
}

SurfaceDistance surface_distance(const TriMesh& result, const TriMesh& truth,
                                 const SurfaceDistanceOptions& options) {
  require(options.samples_per_mm2 > 0.0, "surface_distance: samples_per_mm2 must be positive, got ",
          options.samples_per_mm2);
  require(options.max_samples >= 1, "surface_distance: max_samples must be at least 1, got ",
          options.max_samples);
  if (result.empty() || truth.empty())
    fail(ErrorCode::bad_mesh, "surface_distance: a surface has no triangle");
  const VecX there = signed_distances(judged_samples(result, options, options.seed), truth);
  const VecX back = signed_distances(judged_samples(truth, options, options.seed + 1), result);
  const VecX a = there.cwiseAbs(), b = back.cwiseAbs();
  SurfaceDistance distance;
  distance.assd = 0.5 * (a.mean() + b.mean());
  distance.rms =
      std::sqrt((a.squaredNorm() + b.squaredNorm()) / static_cast<double>(a.size() + b.size()));
  distance.hd95 = std::max(percentile(a, 0.95), percentile(b, 0.95));
  distance.hd = std::max(a.maxCoeff(), b.maxCoeff());
  distance.bias = there.mean();
  return distance;
}

double volume_overlap(const TriMesh& a, const TriMesh& b, double spacing_mm) {
  require(spacing_mm > 0.0, "volume_overlap: spacing must be positive, got ", spacing_mm, " mm");
  const Bounds of_a = bounds(a.points), of_b = bounds(b.points);
  const Vec3 low = of_a.low.cwiseMin(of_b.low), high = of_a.high.cwiseMax(of_b.high);
  const Vec3 extent = (high - low) / spacing_mm;
  require(extent.prod() < 1e9, "volume_overlap: spacing ", spacing_mm,
          " mm gives too many samples");
  std::array<Index, 3> size{};
  for (int k = 0; k < 3; ++k)
    size[static_cast<std::size_t>(k)] = static_cast<Index>(std::ceil(extent[k])) + 1;
  const auto index = [&](const Vec3& p) { return Vec3((p - low) / spacing_mm); };
  const auto in_a = inside_samples(a, size, index), in_b = inside_samples(b, size, index);
  std::int64_t both = 0, sum = 0;
  for (std::size_t i = 0; i < in_a.size(); ++i) {
    both += in_a[i] & in_b[i];
    sum += in_a[i] + in_b[i];
  }
  return sum == 0 ? 0.0 : 2.0 * static_cast<double>(both) / static_cast<double>(sum);
}

}  // namespace coxa
