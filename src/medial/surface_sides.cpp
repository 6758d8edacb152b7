#include <coxa/medial/surface_sides.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/topology.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>

namespace coxa::medial {
namespace {

constexpr double kSharpAngle = 0.5;       // rad: edges bent this much hardly bind their triangles
constexpr double kFacing = 0.3;           // smallest cosine between opposing normals of a sheet
constexpr double kReach = 4.0;            // times the median thickness: no partner beyond
constexpr double kRegularisation = 1e-6;  // of the mean diagonal: keeps the factor definite
constexpr int kInverseIterations = 25;

struct Opposite {
  Index triangle = -1;  // met by the inward ray; -1 where none
  double distance = 0.0;
  double facing = 0.0;  // minus the cosine between the two normals
};

// edge a-b and the two triangles it joins
struct SharedEdge {
  Index a = 0, b = 0, left = 0, right = 0;
};

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

struct Geometry {
  Points centroids, normals;
  VecX areas;
};

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

// lowest eigenvector of the signed Laplacian, by inverse iteration from a seeded start
VecX signed_mode(const Geometry& g, const std::vector<SharedEdge>& edges, const Points& points,
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
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(L);
  Rng rng(1);
  VecX x(n);
  for (Index i = 0; i < n; ++i) x[i] = rng.uniform(-1.0, 1.0);
  for (int k = 0; k < kInverseIterations; ++k) {
    x = factor.solve(g.areas.cwiseProduct(x));
    x /= x.cwiseAbs().maxCoeff();
  }
  return x;
}

// islands of one side inside the other take the label around them: only the largest piece remains
void absorb_islands(const std::vector<SharedEdge>& edges, const VecX& areas,
                    std::vector<SideLabel>& labels, SideLabel side) {
  const std::size_t n = labels.size();
  std::vector<Index> parent(n);
  for (std::size_t i = 0; i < n; ++i) parent[i] = static_cast<Index>(i);
  auto root = [&](Index i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
      auto& p = parent[static_cast<std::size_t>(i)];
      p = parent[static_cast<std::size_t>(p)];
      i = p;
    }
    return i;
  };
  auto on_side = [&](Index t) { return labels[static_cast<std::size_t>(t)] == side; };
  for (const SharedEdge& e : edges) {
    if (!on_side(e.left) || !on_side(e.right)) continue;
    const Index a = root(e.left), b = root(e.right);
    parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  VecX total = VecX::Zero(static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) {
    if (labels[i] == side) total[root(static_cast<Index>(i))] += areas[static_cast<Index>(i)];
  }
  Eigen::Index largest = 0;
  if (total.maxCoeff(&largest) <= 0.0) return;
  const SideLabel other = side == SideLabel::first ? SideLabel::second : SideLabel::first;
  for (std::size_t i = 0; i < n; ++i) {
    if (labels[i] == side && root(static_cast<Index>(i)) != largest) labels[i] = other;
  }
}

// median over the area of the distance to the opposite triangle, where the two face each other
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

bool may_be_partner(const Opposite& o, double reach) {
  return o.triangle >= 0 && o.facing > kFacing && o.distance <= reach;
}

double relative_thickness(double thickness, const VecX& areas) {
  return thickness / std::sqrt(0.5 * areas.sum());
}

struct Pairing {
  const VecX& x;  // the signed mode
  const std::vector<Opposite>& opposites;
  double reach;  // mm: what lies further across is no partner (walls that face each other)

  bool has_partner(Index t) const {
    const Opposite& o = opposites[static_cast<std::size_t>(t)];
    return may_be_partner(o, reach) && (x[t] > 0) != (x[o.triangle] > 0);
  }
};

// a rim triangle without rim neighbours across two of its edges is no wall: its side again
void drop_specks(const std::vector<SharedEdge>& edges, const std::vector<SideLabel>& sides,
                 std::vector<SideLabel>& labels) {
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<int> rim_neighbours(labels.size(), 0);
    for (const SharedEdge& e : edges) {
      const auto l = static_cast<std::size_t>(e.left), r = static_cast<std::size_t>(e.right);
      if (labels[l] == SideLabel::rim && labels[r] == SideLabel::rim) {
        ++rim_neighbours[l];
        ++rim_neighbours[r];
      }
    }
    for (std::size_t t = 0; t < labels.size(); ++t) {
      if (labels[t] != SideLabel::rim || rim_neighbours[t] > 1) continue;
      labels[t] = sides[t];
      changed = true;
    }
  }
}

// unpaired triangles reached from the change of sign through unpaired triangles are rim
void grow_rim(const std::vector<SharedEdge>& edges, const Pairing& pairing,
              std::vector<SideLabel>& labels) {
  std::vector<char> reached(labels.size(), 0);
  const auto at = [](Index t) { return static_cast<std::size_t>(t); };
  const std::vector<SideLabel> before = labels;
  for (const SharedEdge& e : edges) {
    if (before[at(e.left)] != before[at(e.right)]) reached[at(e.left)] = reached[at(e.right)] = 1;
  }
  for (bool grew = true; grew;) {
    grew = false;
    for (const SharedEdge& e : edges) {
      for (const auto& [from, to] : {std::pair{e.left, e.right}, std::pair{e.right, e.left}}) {
        if (!reached[at(from)] || reached[at(to)] || pairing.has_partner(from)) continue;
        reached[at(to)] = 1;
        grew = true;
      }
    }
  }
  for (std::size_t t = 0; t < labels.size(); ++t) {
    if (reached[t] && !pairing.has_partner(static_cast<Index>(t))) labels[t] = SideLabel::rim;
  }
  drop_specks(edges, before, labels);
}

}  // namespace

SurfaceSides split_sides(const TriMesh& surface) {
  const std::vector<SharedEdge> edges = shared_edges(surface);
  const Geometry g = triangle_geometry(surface);
  const std::vector<Opposite> opposites = find_opposites(surface, g);
  const VecX x = signed_mode(g, edges, surface.points, opposites);

  const double thickness = median_thickness(g.areas, opposites);
  const Pairing pairing{x, opposites, kReach * thickness};

  SurfaceSides sides;
  sides.relative_thickness = relative_thickness(thickness, g.areas);
  sides.labels.resize(opposites.size());
  sides.thickness.resize(surface.n_triangles());
  double paired = 0.0;
  for (Index t = 0; t < surface.n_triangles(); ++t) {
    const Opposite& o = opposites[static_cast<std::size_t>(t)];
    sides.labels[static_cast<std::size_t>(t)] = x[t] > 0 ? SideLabel::first : SideLabel::second;
    sides.thickness[t] = o.triangle >= 0 ? o.distance : kNaN;
    if (pairing.has_partner(t)) paired += g.areas[t];
  }
  sides.sheetness = paired / g.areas.sum();
  absorb_islands(edges, g.areas, sides.labels, SideLabel::first);
  absorb_islands(edges, g.areas, sides.labels, SideLabel::second);
  grow_rim(edges, pairing, sides.labels);
  return sides;
}

FacingBound facing_bound(const TriMesh& surface) {
  require_closed_manifold(surface, "surface to split into two faces");
  const Geometry g = triangle_geometry(surface);
  const std::vector<Opposite> opposites = find_opposites(surface, g);
  const double thickness = median_thickness(g.areas, opposites);
  double facing = 0.0;
  for (Index t = 0; t < surface.n_triangles(); ++t)
    if (may_be_partner(opposites[static_cast<std::size_t>(t)], kReach * thickness))
      facing += g.areas[t];
  return {facing / g.areas.sum(), relative_thickness(thickness, g.areas)};
}

}  // namespace coxa::medial
