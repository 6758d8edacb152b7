#include <coxa/medial/surface_sides.h>

#include "signed_mode.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/topology.h>

#include <algorithm>
#include <cmath>

namespace coxa::medial {
namespace {

constexpr double kReach = 4.0;  // times the median thickness: no partner beyond

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

bool may_be_partner(const Opposite& o, double reach) {
  return o.triangle >= 0 && o.facing > kFacing && o.distance <= reach;
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
  const VecX x = signed_mode(surface, edges, g, opposites);

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
