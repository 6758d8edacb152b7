#include "cover.h"

#include "element_shape.h"
#include "grid_topology.h"
#include "surface_places.h"
#include "tet_boundary.h"
#include "worst_elements.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/closest_point.h>
#include <coxa/geom/triangle_tree.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

namespace coxa::meshing {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

constexpr double kMuchTooFar = 0.2;  // mm
// ranks of elements (see `element_rank`) around a node that is moved, and where it is urgent
constexpr double kRank = 1.2, kUrgentRank = 0.85;

// of ascending lists
std::vector<Index> united(const std::vector<Index>& a, const std::vector<Index>& b) {
  std::vector<Index> all;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

struct Place {
  Vec3 p = Vec3::Zero();
  Facet facet{};  // of the boundary, nearest
  double distance = 0.0;
};

double mean_edge(const TetGrid& grid, const Triangles& facets) {
  double sum = 0.0;
  for (Index f = 0; f < facets.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      sum += (grid.x[at(facets(f, k))] - grid.x[at(facets(f, (k + 1) % 3))]).norm();
  return sum / (3.0 * static_cast<double>(facets.rows()));
}

// where the boundary is nearest to some points
std::vector<Place> places_at(const std::vector<Vec3>& points, const TetGrid& grid,
                             const Triangles& facets) {
  Points nodes(static_cast<Index>(grid.x.size()), 3);
  for (std::size_t v = 0; v < grid.x.size(); ++v) nodes.row(static_cast<Index>(v)) = grid.x[v];
  const TriangleTree tree(nodes, facets);
  std::vector<Place> places(points.size());
  parallel_for(static_cast<std::int64_t>(places.size()), [&](Index i) {
    Place& place = places[at(i)];
    place.p = points[at(i)];
    const NearestPoint nearest = tree.nearest(place.p);
    for (int k = 0; k < 3; ++k) place.facet[at(k)] = facets(nearest.triangle, k);
    place.distance = std::sqrt(nearest.squared_distance);
  });
  return places;
}

// along ridges, of the mean edge of the boundary
constexpr double kSpacing = 0.4;

NodeKind kept(NodeKind kind) {
  if (on_first_face(kind)) return NodeKind::first_corner;
  return on_second_face(kind) ? NodeKind::second_corner : NodeKind::rim_corner;
}

bool may_go(NodeKind kind) {
  return !is_fixed(kind) && kind != NodeKind::inside && kind != NodeKind::rim_band;
}

class Cover {
 public:
  Cover(TetGrid& grid, std::vector<Place> places)
      : grid_(grid), places_(std::move(places)), near_(grid.x.size()) {
    for (std::size_t i = 0; i < places_.size(); ++i)
      for (const Index v : places_[i].facet) near_[at(v)].push_back(static_cast<Index>(i));
  }

  // the corner of the nearest facet that can go there at least cost goes
  bool draw_to(const Place& place, double worst) {
    std::vector<std::pair<double, Index>> order;
    for (const Index v : place.facet) order.emplace_back((grid_.x[at(v)] - place.p).norm(), v);
    std::sort(order.begin(), order.end());
    for (const auto& [distance, v] : order)
      if (may_go(grid_.kinds[at(v)]) && try_node(v, place, worst)) {
        grid_.kinds[at(v)] = kept(grid_.kinds[at(v)]);
        grid_.reach[at(v)] = 0.0;
        return true;
      }
    return false;
  }

  // an edge of the nearest facet gets a new node there
  // @returns elements more, at most `room`; 0 where no edge can be split
  Index split_to(const Place& place, double worst, std::ptrdiff_t room) {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = grid_.x[at(place.facet[k])], &b = grid_.x[at(place.facet[(k + 1) % 3])];
      order.emplace_back(closest_point_on_triangle(place.p, a, b, b).squared_distance, k);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [distance, k] : order)
      if (const Index more =
              try_split(place.facet[k], place.facet[(k + 1) % 3], place, worst, room))
        return more;
    return 0;
  }

 private:
  // what is much too far is worth elements nearer to the limits
  static bool is_urgent(const Place& place) { return place.distance > kMuchTooFar; }
  static double rank_for(const Place& place) { return is_urgent(place) ? kUrgentRank : kRank; }

  // the elements around the edge, each in two with a new node at the target
  Index try_split(Index a, Index b, const Place& place, double worst, std::ptrdiff_t room) {
    if (!has_edge(grid_, a, b) || !edge_on_boundary(grid_, a, b)) return 0;
    const std::vector<Index> old = ring_around(grid_, a, b).tets;
    if (old.empty() || std::ssize(old) > room) return 0;
    std::vector<Tet> before, made;
    const auto v = static_cast<Index>(grid_.x.size());
    for (const Index t : old) {
      before.push_back(grid_.tets[at(t)]);
      for (const Index end : {a, b}) {
        made.push_back(before.back());
        std::replace(made.back().begin(), made.back().end(), end, v);
      }
    }
    add_node(a, b, place.p);
    if (worst_rank(made) < std::min(rank_for(place), worst_rank(before)) ||
        worst_energy_of(made) > 3.0 * worst) {
      drop_last_node();
      return 0;
    }
    const double missed = farthest({a, b}, near_[at(v)]);
    for (const Index t : old) grid_.remove(t);
    std::vector<Index> numbers;
    for (const Tet& t : made) numbers.push_back(grid_.add(t));
    if (farthest({a, b, v}, near_[at(v)]) <= missed)
      return static_cast<Index>(made.size() - before.size());
    for (const Index t : numbers) grid_.remove(t);
    for (const Tet& t : before) grid_.add(t);
    drop_last_node();
    return 0;
  }

  void add_node(Index a, Index b, const Vec3& p) {
    grid_.x.push_back(p);
    grid_.kinds.push_back(kept(grid_.kinds[at(on_first_face(grid_.kinds[at(a)]) ? a : b)]));
    grid_.levels.push_back(0.5 * (grid_.levels[at(a)] + grid_.levels[at(b)]));
    grid_.reach.push_back(0.0);
    grid_.around.emplace_back();
    near_.push_back(united(near_[at(a)], near_[at(b)]));
  }
  void drop_last_node() {
    grid_.x.pop_back();
    grid_.kinds.pop_back();
    grid_.levels.pop_back();
    grid_.reach.pop_back();
    grid_.around.pop_back();
    near_.pop_back();
  }
  double worst_energy_of(const std::vector<Tet>& tets) const {
    double worst = 0.0;
    for (const Tet& n : tets)
      worst = std::max(worst, shape_energy(grid_.x[at(n[0])], grid_.x[at(n[1])], grid_.x[at(n[2])],
                                           grid_.x[at(n[3])]));
    return worst;
  }
  double worst_rank(const std::vector<Tet>& tets) const {
    double worst = kInfinity;
    for (const Tet& t : tets) worst = std::min(worst, element_rank(grid_, t));
    return worst;
  }

  bool try_node(Index v, const Place& place, double worst) {
    const Vec3 old = grid_.x[at(v)];
    const double wanted = std::min(rank_for(place), rank_around(v));
    const double allowed = std::max(is_urgent(place) ? 3.0 * worst : worst, energy_around(v));
    std::optional<double> before;  // dear, and rarely needed
    for (const double share : {1.0, 0.75, 0.5}) {
      grid_.x[at(v)] = old + share * (place.p - old);
      if (energy_around(v) > allowed || rank_around(v) < wanted) continue;
      if (!before) {
        const Vec3 there = std::exchange(grid_.x[at(v)], old);
        before = farthest_near(v);
        grid_.x[at(v)] = there;
      }
      if (farthest_near(v) < 0.8 * *before) return true;
    }
    grid_.x[at(v)] = old;
    return false;
  }

  double energy_around(Index v) const { return worst_energy(grid_, v); }

  double rank_around(Index v) const {
    double worst = kInfinity;
    for (const Index t : grid_.around[at(v)])
      worst = std::min(worst, element_rank(grid_, grid_.tets[at(t)]));
    return worst;
  }

  double farthest_near(Index v) const { return farthest({v}, near_[at(v)]); }

  // of some places from the facets around some nodes
  double farthest(const std::vector<Index>& nodes, const std::vector<Index>& places) const {
    std::vector<Facet> facets;
    for (const Index v : nodes)
      for (const Index t : grid_.around[at(v)])
        for (std::size_t k = 0; k < 4; ++k) {
          if (grid_.tets[at(t)][k] == v) continue;
          const Facet f = facet_opposite(grid_.tets[at(t)], k);
          if (on_boundary(grid_, f)) facets.push_back(f);
        }
    double farthest = 0.0;
    for (const Index i : places) {
      double nearest = kInfinity;
      for (const auto& [a, b, c] : facets)
        nearest = std::min(nearest, closest_point_on_triangle(places_[at(i)].p, grid_.x[at(a)],
                                                              grid_.x[at(b)], grid_.x[at(c)])
                                        .squared_distance);
      farthest = std::max(farthest, nearest);
    }
    return std::sqrt(farthest);
  }

  TetGrid& grid_;
  std::vector<Place> places_;
  std::vector<std::vector<Index>> near_;  // places by the corners of their nearest facets
};

}  // namespace

Index cover_far_places(TetGrid& grid, const TriMesh& surface, const CoverOptions& options) {
  const Triangles facets = boundary_of(grid);
  std::vector<Place> places =
      places_at(places_on(surface, kSpacing * mean_edge(grid, facets)), grid, facets);
  std::vector<Place> far;
  for (const Place& place : places)
    if (place.distance > options.limit) far.push_back(place);
  std::stable_sort(far.begin(), far.end(),
                   [](const Place& a, const Place& b) { return a.distance > b.distance; });
  // more of them mean that the elements are too few: one here and there would not help
  far.resize(std::min(far.size(), options.most));
  Cover cover(grid, std::move(places));
  Index drawn = 0;
  std::ptrdiff_t room = options.room;
  for (const Place& place : far) {
    if (cover.draw_to(place, options.worst)) {
      ++drawn;
    } else if (const Index more = cover.split_to(place, options.worst, room)) {
      room -= more;
      ++drawn;
    }
  }
  return drawn;
}

}  // namespace coxa::meshing
