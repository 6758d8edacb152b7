#include "signed_mode.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/remesh.h>
#include <coxa/mesh/topology.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>

namespace coxa::medial {
namespace {

constexpr double kSharpAngle = 0.5;       // rad: edges bent this much hardly bind their triangles
constexpr double kRegularisation = 1e-6;  // of the mean diagonal: keeps the factor definite
constexpr int kInverseIterations = 25;
// triangles; a thick body's ties across it fill the factor, a sheet's do not
constexpr Index kMostFactored = 60000, kMostOfThick = 10000;
constexpr double kThick = 0.15;  // relative thickness; that of cartilage is about 0.05

// signed Laplacian: along the surface neighbours agree, across the body they are opposite
Eigen::SparseMatrix<double> signed_laplacian(const Geometry& g,
                                             const std::vector<SharedEdge>& edges,
                                             const Points& points,
                                             const std::vector<Opposite>& opposites) {
  const Index n = static_cast<Index>(g.areas.size());
  std::vector<Eigen::Triplet<double>> entries;
  VecX diagonal = VecX::Zero(n);
  auto couple = [&](Index i, Index j, double weight, double sign) {
    diagonal[i] += weight;
    diagonal[j] += weight;
    entries.emplace_back(std::max(i, j), std::min(i, j), -sign * weight);
  };
  for (const SharedEdge& e : edges) {
    const double length = (points.row(e.a) - points.row(e.b)).norm();
    const double apart = (g.centroids.row(e.left) - g.centroids.row(e.right)).norm();
    const double bend =
        std::acos(std::clamp(g.normals.row(e.left).dot(g.normals.row(e.right)), -1.0, 1.0));
    const double weight = std::exp(-std::pow(bend / kSharpAngle, 2)) + 1e-4;
    couple(e.left, e.right, weight * length / std::max(apart, 1e-9), 1.0);
  }
  for (Index i = 0; i < n; ++i) {
    const Opposite& o = opposites[static_cast<std::size_t>(i)];
    if (o.triangle < 0 || o.facing <= 0.0 || o.distance <= 0.0) continue;
    const double reach = std::max(o.distance, std::sqrt(g.areas[i]));
    couple(i, o.triangle, std::pow(o.facing, 3) * g.areas[i] / (reach * reach), -1.0);
  }
  const double shift = kRegularisation * diagonal.mean();
  for (Index i = 0; i < n; ++i) entries.emplace_back(i, i, diagonal[i] + shift);
  Eigen::SparseMatrix<double> L(n, n);
  L.setFromTriplets(entries.begin(), entries.end());
  return L;
}

// its lowest eigenvector, by inverse iteration from a seeded start
VecX lowest_mode(const Eigen::SparseMatrix<double>& L, const VecX& areas) {
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(L);
  Rng rng(1);
  VecX x(areas.size());
  for (double& value : x) value = rng.uniform(-1.0, 1.0);
  for (int k = 0; k < kInverseIterations; ++k) {
    x = factor.solve(areas.cwiseProduct(x));
    x /= x.cwiseAbs().maxCoeff();
  }
  return x;
}

// the mode of a coarser surface, evened by relaxation: a factor would take minutes
VecX mode_from_coarser(const TriMesh& surface, const Geometry& g,
                       const Eigen::SparseMatrix<double>& L, double thickness, Index most) {
  constexpr int kRelaxations = 30;
  constexpr double kOutward = 0.25;  // of the thickness: what is nearest then is on the same face
  const TriMesh coarse = decimate(surface, {.n_triangles = most / 2});
  if (coarse.n_triangles() > most)
    fail(ErrorCode::bad_mesh, "a surface of ", surface.n_triangles(),
         " triangles cannot be made coarser, to be split into two faces");
  const Geometry coarse_geometry = triangle_geometry(coarse);
  const VecX mode = signed_mode(coarse, shared_edges(coarse), coarse_geometry,
                                find_opposites(coarse, coarse_geometry));
  const TriangleTree tree(coarse.points, coarse.triangles);
  VecX x(surface.n_triangles());
  parallel_for(surface.n_triangles(), [&](Index t) {
    const Vec3 p = g.centroids.row(t) + kOutward * thickness * g.normals.row(t);
    x[t] = mode[tree.nearest(p).triangle];
  });
  const VecX diagonal = L.diagonal();
  for (int k = 0; k < kRelaxations; ++k)
    x -= 0.5 * (L.selfadjointView<Eigen::Lower>() * x).cwiseQuotient(diagonal);
  return x;
}

}  // namespace

std::vector<SharedEdge> shared_edges(const TriMesh& surface) {
  require_closed_manifold(surface, "surface to split into two faces");
  const MeshEdges edges = mesh_edges(surface);
  std::vector<SharedEdge> shared;
  for (Index e = 0; e < edges.triangles.size(); ++e) {
    const auto pair = edges.triangles[e];
    shared.push_back({edges.vertices(e, 0), edges.vertices(e, 1), pair[0], pair[1]});
  }
  return shared;
}

Geometry triangle_geometry(const TriMesh& surface) {
  Geometry g;
  g.centroids.resize(surface.n_triangles(), 3);
  g.normals.resize(surface.n_triangles(), 3);
  g.areas.resize(surface.n_triangles());
  for (Index t = 0; t < surface.n_triangles(); ++t) {
    const Vec3 a = surface.points.row(surface.triangles(t, 0));
    const Vec3 b = surface.points.row(surface.triangles(t, 1));
    const Vec3 c = surface.points.row(surface.triangles(t, 2));
    const Vec3 n = (b - a).cross(c - a);
    g.centroids.row(t) = (a + b + c) / 3.0;
    g.areas[t] = 0.5 * n.norm();
    g.normals.row(t) = n / std::max(n.norm(), 1e-300);
  }
  return g;
}

std::vector<Opposite> find_opposites(const TriMesh& surface, const Geometry& g) {
  const TriangleTree tree(surface.points, surface.triangles);
  const double diagonal =
      (surface.points.colwise().maxCoeff() - surface.points.colwise().minCoeff()).norm();
  std::vector<Opposite> opposites(static_cast<std::size_t>(surface.n_triangles()));
  parallel_for(surface.n_triangles(), [&](Index t) {
    const Vec3 inward = -g.normals.row(t).transpose();
    if (inward.squaredNorm() < 0.5) return;
    const double offset = 1e-6 * diagonal;
    const Vec3 origin = g.centroids.row(t).transpose() + offset * inward;
    const auto hit = tree.first_hit(origin, inward, diagonal);
    if (!hit || hit->triangle == t) return;
    opposites[static_cast<std::size_t>(t)] = {hit->triangle, hit->distance + offset,
                                              inward.dot(g.normals.row(hit->triangle))};
  });
  return opposites;
}

double median_thickness(const VecX& areas, const std::vector<Opposite>& opposites) {
  std::vector<std::pair<double, double>> facing;  // distance, area
  double total = 0.0;
  for (std::size_t t = 0; t < opposites.size(); ++t) {
    if (opposites[t].triangle < 0 || opposites[t].facing <= kFacing) continue;
    facing.emplace_back(opposites[t].distance, areas[static_cast<Index>(t)]);
    total += areas[static_cast<Index>(t)];
  }
  std::sort(facing.begin(), facing.end());
  double sum = 0.0;
  for (const auto& [distance, area] : facing) {
    sum += area;
    if (sum >= 0.5 * total) return distance;
  }
  return 0.0;
}

double relative_thickness(double thickness, const VecX& areas) {
  return thickness / std::sqrt(0.5 * areas.sum());
}

VecX signed_mode(const TriMesh& surface, const std::vector<SharedEdge>& edges, const Geometry& g,
                 const std::vector<Opposite>& opposites) {
  const auto L = signed_laplacian(g, edges, surface.points, opposites);
  const double thickness = median_thickness(g.areas, opposites);
  const Index most = relative_thickness(thickness, g.areas) > kThick ? kMostOfThick : kMostFactored;
  return surface.n_triangles() <= most ? lowest_mode(L, g.areas)
                                       : mode_from_coarser(surface, g, L, thickness, most);
}

}  // namespace coxa::medial
