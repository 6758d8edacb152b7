#include "sphere_region.h"

#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/geom/fits.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/vertex_normals.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "head_completion.h"

namespace coxa::motion {
namespace {

// normals count as radial within this cosine (37 degrees: wide, because surfaces from images are
// rough)
constexpr double kRadialCosine = 0.8;

Sphere fit_region(const SurfaceSamples& samples, const std::vector<Index>& region,
                  double outlier_scale) {
  require(region.size() >= 30, "only ", region.size(),
          " triangles look like part of a femoral head; 30 are needed");
  return fit_sphere(samples.points(region, Eigen::all), samples.areas(region),
                    {.outlier_scale = outlier_scale});
}

// share of the sphere's directions with a region point within 10 degrees
double covered_share(const Points& points, const Vec3& centre) {
  constexpr Index kDirections = 300;
  const double near = std::cos(radians(10.0));
  const Points seen = (points.rowwise() - centre.transpose()).rowwise().normalized();
  const Points directions = spiral_directions(kDirections);
  int covered = 0;
  for (Index k = 0; k < kDirections; ++k) {
    if ((seen * directions.row(k).transpose()).maxCoeff() > near) ++covered;
  }
  return static_cast<double>(covered) / kDirections;
}

// half-width of the 95 % interval by leaving out one of eight sectors at a time (jackknife over
// sectors: errors of a surface are alike near by, so single points are no independent witnesses)
double sector_interval(const SurfaceSamples& samples, const RegionFit& fit, double outlier_scale) {
  constexpr int kSectors = 8;
  const Points points = samples.points(fit.region, Eigen::all);
  const Vec3 pole = (points.colwise().mean().transpose() - fit.sphere.centre).normalized();
  const Vec3 u = pole.unitOrthogonal(), v = pole.cross(u);
  std::vector<Vec3> centres;
  for (int sector = 0; sector < kSectors; ++sector) {
    std::vector<Index> kept;
    for (std::size_t k = 0; k < fit.region.size(); ++k) {
      const Vec3 d = points.row(static_cast<Eigen::Index>(k)).transpose() - fit.sphere.centre;
      const double angle = std::atan2(d.dot(v), d.dot(u)) + kPi;
      const int of_point = std::min(kSectors - 1, static_cast<int>(angle / (2.0 * kPi) * kSectors));
      if (of_point != sector) kept.push_back(fit.region[k]);
    }
    if (kept.size() >= 30) centres.push_back(fit_region(samples, kept, outlier_scale).centre);
  }
  if (centres.size() < 2) return kInfinity;
  const auto n = static_cast<double>(centres.size());
  const Vec3 mean = std::accumulate(centres.begin(), centres.end(), Vec3::Zero().eval()) / n;
  double sum = 0.0;
  for (const Vec3& c : centres) sum += (c - mean).squaredNorm();
  return 1.96 * std::sqrt((n - 1.0) / n * sum / 3.0);
}

JointCentre as_centre(const SurfaceSamples& samples, const RegionFit& fit, double outlier_scale) {
  JointCentre result;
  result.centre = fit.sphere.centre;
  result.radius = fit.sphere.radius;
  result.rms = fit.sphere.rms;
  result.covered_share = covered_share(samples.points(fit.region, Eigen::all), fit.sphere.centre);
  result.interval = sector_interval(samples, fit, outlier_scale);
  return result;
}

}  // namespace

SurfaceSamples surface_samples(const TriMesh& mesh) {
  constexpr double kNeighbourhood = 3.0;  // mm over which normals are averaged
  SurfaceSamples samples;
  samples.areas = triangle_areas(mesh);
  samples.points.resize(mesh.n_triangles(), 3);
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    samples.points.row(t) = mesh.points(mesh.triangles.row(t), Eigen::all).colwise().mean();
  }
  // each round spreads the vertex normals by about one edge; a random walk needs the square of the
  // distance
  const Adjacency neighbours = vertex_neighbours(mesh);
  const double edge = std::max(0.1, mean_edge_length(mesh));
  const int rounds = std::clamp(static_cast<int>(std::pow(kNeighbourhood / edge, 2)), 1, 60);
  Points normals = vertex_normals(mesh);
  for (int round = 0; round < rounds; ++round) {
    Points next = normals;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      for (const Index w : neighbours[v]) next.row(v) += normals.row(w);
    }
    normals = next.rowwise().normalized();
  }
  samples.normals.resize(mesh.n_triangles(), 3);
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    samples.normals.row(t) =
        normals(mesh.triangles.row(t), Eigen::all).colwise().mean().normalized();
  }
  return samples;
}

std::optional<Vec3> find_head(const SurfaceSamples& samples, double smallest_radius,
                              double largest_radius) {
  constexpr int kTrials = 3000;
  constexpr double kBand = 1.5;  // mm
  Rng rng(20260);                // fixed: the search is part of a deterministic function
  const auto n = static_cast<Index>(samples.points.rows());
  const Index stride = std::max<Index>(1, n / 2000);
  double best = 0.0;
  std::optional<Vec3> found;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Index a = rng.below(n), b = rng.below(n);
    const Vec3 pa = samples.points.row(a), pb = samples.points.row(b);
    const Vec3 na = samples.normals.row(a), nb = samples.normals.row(b);
    // c = p - r n for both points: r from the difference along the difference of normals
    const Vec3 dn = na - nb;
    if (dn.squaredNorm() < 0.1) continue;
    const double radius = (pa - pb).dot(dn) / dn.squaredNorm();
    if (radius < smallest_radius || radius > largest_radius) continue;
    const Vec3 centre = 0.5 * (pa - radius * na + pb - radius * nb);
    double support = 0.0;
    for (Index k = 0; k < n; k += stride) {
      const Vec3 d = samples.points.row(k).transpose() - centre;
      const double distance = d.norm();
      if (std::abs(distance - radius) > kBand) continue;
      if (d.dot(samples.normals.row(k).transpose()) > 0.9 * distance) support += samples.areas[k];
    }
    support *= stride / (radius * radius);  // solid angle, not area: no bonus for a large sphere
    if (support > best) {
      best = support;
      found = centre;
    }
  }
  return best > 1.0 ? found : std::nullopt;  // at least a twelfth of a sphere
}

Points spiral_directions(Index n) {
  Points directions(n, 3);
  for (Index k = 0; k < n; ++k) {
    const double z = 1.0 - (2.0 * k + 1.0) / n, a = k * kPi * (3.0 - std::sqrt(5.0));
    const double across = std::sqrt(1.0 - z * z);
    directions.row(k) = Vec3(across * std::cos(a), across * std::sin(a), z);
  }
  return directions;
}

Vec3 neck_direction(const SurfaceSamples& samples, const Vec3& centre, double radius) {
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index k = 0; k < samples.points.rows(); ++k) {
    const Vec3 d = samples.points.row(k).transpose() - centre;
    if (d.norm() > 1.3 * radius && d.norm() < 2.0 * radius) sum += samples.areas[k] * d;
  }
  return sum.squaredNorm() > 0 ? sum.normalized() : Vec3::Zero().eval();
}

namespace {

double median_distance(const SurfaceSamples& samples, const Vec3& centre, Facing facing) {
  std::vector<double> distances;
  for (Eigen::Index k = 0; k < samples.points.rows(); ++k) {
    const Vec3 d = samples.points.row(k).transpose() - centre;
    const double sign = facing == Facing::outward ? 1.0 : -1.0;
    if (d.norm() < 40.0 &&
        sign * d.dot(samples.normals.row(k).transpose()) > kRadialCosine * d.norm()) {
      distances.push_back(d.norm());
    }
  }
  if (distances.empty()) return 0.0;
  std::nth_element(distances.begin(),
                   distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2),
                   distances.end());
  return distances[distances.size() / 2];
}

}  // namespace

std::vector<Index> find_region(const SurfaceSamples& samples, const Sphere& sphere,
                               const RegionRule& rule) {
  std::vector<Index> region;
  for (Index k = 0; k < samples.points.rows(); ++k) {
    const Vec3 d = samples.points.row(k).transpose() - sphere.centre;
    const double distance = d.norm();
    if (std::abs(distance - sphere.radius) > rule.band) continue;
    if (rule.sign * d.dot(samples.normals.row(k).transpose()) < kRadialCosine * distance) continue;
    if (d.dot(rule.neck) > rule.neck_cosine * distance) continue;
    region.push_back(k);
  }
  return region;
}

namespace {

// alternates between choosing the region and fitting it, with a band that narrows from 6 to 2 mm
RegionFit fit_with_region(const SurfaceSamples& samples, Sphere sphere, RegionRule rule,
                          bool leave_neck_out, const JointCentreOptions& options) {
  RegionFit fit{sphere, {}};
  for (int round = 0; round < 12; ++round) {
    rule.band = std::max(2.0, 6.0 - round);
    if (leave_neck_out) rule.neck = neck_direction(samples, fit.sphere.centre, fit.sphere.radius);
    rule.neck_cosine = leave_neck_out ? std::cos(options.neck_cone) : 1.0;
    fit.region = find_region(samples, fit.sphere, rule);
    const Vec3 before = fit.sphere.centre;
    fit.sphere = fit_region(samples, fit.region, options.outlier_scale);
    if (rule.band == 2.0 && (fit.sphere.centre - before).norm() < 1e-4) break;
  }
  return fit;
}

}  // namespace

RegionFit fit_off_neck(const SurfaceSamples& samples, const Sphere& first,
                       const JointCentreOptions& options) {
  return fit_with_region(samples, first, {}, true, options);
}

Sphere first_sphere(const SurfaceSamples& samples, const Vec3& start) {
  return {.centre = start, .radius = median_distance(samples, start, Facing::outward), .rms = 0.0};
}

JointCentre fit_femoral_head(const SurfaceSamples& samples, const Vec3& start,
                             const JointCentreOptions& options) {
  const RegionFit seen = fit_off_neck(samples, first_sphere(samples, start), options);
  JointCentre result = as_centre(samples, seen, options.outlier_scale);
  result.definition = "femoral_head";
  result.region =
      join_text("femur within 2 mm of the sphere, facing outward, farther than ",
                std::lround(degrees(options.neck_cone)), " degrees from the neck's direction");
  if (!options.head_prior) return result;
  const CompletedHead completed = complete_head(samples, seen, *options.head_prior, options);
  if (completed.added_share == 0) return result;
  const RegionFit whole = fit_off_neck(completed.samples, seen.sphere, options);
  result.centre = whole.sphere.centre;
  result.radius = whole.sphere.radius;
  result.interval = std::hypot(result.interval, 1.96 * completed.centre_sd);
  result.region += join_text("; ", std::lround(100.0 * completed.added_share),
                             " % of it not in view, completed by the mean shape of heads");
  return result;
}

JointCentre fit_facing(const SurfaceSamples& samples, const Vec3& start, Facing facing,
                       const JointCentreOptions& options) {
  const Sphere first{
      .centre = start, .radius = median_distance(samples, start, facing), .rms = 0.0};
  RegionRule rule;
  rule.sign = facing == Facing::outward ? 1.0 : -1.0;
  return as_centre(samples, fit_with_region(samples, first, rule, false, options),
                   options.outlier_scale);
}

TriMesh facing_part(const TriMesh& mesh, const Vec3& centre, Facing facing) {
  const SurfaceSamples samples = surface_samples(mesh);
  const double sign = facing == Facing::outward ? 1.0 : -1.0;
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Vec3 d = samples.points.row(t).transpose() - centre;
    if (sign * d.dot(samples.normals.row(t).transpose()) > 0.5 * d.norm()) kept.push_back(t);
  }
  require(!kept.empty(), "no part of the cartilage faces the joint");
  return sub_mesh(mesh, kept).mesh;
}

}  // namespace coxa::motion
