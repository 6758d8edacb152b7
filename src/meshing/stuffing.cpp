#include "grid_topology.h"
#include "lattice.h"

#include <coxa/core/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace coxa::meshing {
namespace {

// a cut nearer than this share of an edge to its end moves that end
constexpr double kSnapAxis = 0.25, kSnapDiagonal = 0.4;
// cuts of edges whose ends had to stay keep this far away from them
constexpr double kLeastShare = 0.12;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

using Edge = std::pair<Index, Index>;

class Stuffing {
 public:
  Stuffing(const Lattice& lattice, const TriangleTree& surface) : lattice_(lattice) {
    VecX values(static_cast<Index>(lattice.points.size()));
    parallel_for(values.size(),
                 [&](Index v) { values[v] = -surface.signed_distance(lattice.points[at(v)]); });
    original_.assign(values.begin(), values.end());
    for (const Tet& t : lattice.tets)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j)
          add_if_cut(std::min(t[i], t[j]), std::max(t[i], t[j]));
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    cut_at_.resize(original_.size());
    for (std::size_t e = 0; e < edges_.size(); ++e)
      for (const Index v : {edges_[e].first, edges_[e].second})
        cut_at_[at(v)].push_back(static_cast<Index>(e));
    stays_.assign(original_.size(), 0);
  }

  TetGrid build() {
    values_ = original_;
    grid_ = {};
    grid_.x = regular_ = lattice_.points;
    folded_.clear();
    snap();
    add_cuts();
    for (const Tet& t : lattice_.tets) fill(t);
    grid_.levels.assign(grid_.x.size(), 0.0);
    grid_.link();
    grid_.kinds.assign(grid_.x.size(), NodeKind::inside);
    const std::vector<char> outer = boundary_nodes(grid_);
    for (std::size_t v = 0; v < outer.size(); ++v)
      if (outer[v]) grid_.kinds[v] = NodeKind::first_face;
    return std::move(grid_);
  }

  /// Nodes of elements that moved lattice points folded over.
  const std::vector<Index>& folded() const { return folded_; }

  /// Keeps the lattice points behind these nodes where they are. @returns whether any moved before
  bool hold(const std::vector<Index>& nodes) {
    bool any = false;
    for (const Index v : nodes)
      if (at(v) < stays_.size() && !stays_[at(v)]) {
        stays_[at(v)] = 1;
        any = true;
      }
    return any;
  }

 private:
  double value(Index v) const { return values_[at(v)]; }

  // a point on the surface that may not move counts as outside
  static double off_zero(double value) { return value == 0.0 ? -1e-9 : value; }

  void add_if_cut(Index a, Index b) {
    if ((off_zero(original_[at(a)]) > 0.0) != (off_zero(original_[at(b)]) > 0.0))
      edges_.emplace_back(a, b);
  }

  double snap_share(Index a, Index b) const {
    return lattice_.is_centre[at(a)] == lattice_.is_centre[at(b)] ? kSnapAxis : kSnapDiagonal;
  }

  double share_of(const Edge& e) const {
    const double a = off_zero(original_[at(e.first)]), b = off_zero(original_[at(e.second)]);
    return a / (a - b);
  }

  // moves lattice points onto the nearest cut of their edges that is near enough
  void snap() {
    struct Pull {
      double distance = kInfinity;
      Index other = -1;
    };
    for (double& v : values_) v = off_zero(v);
    for (std::size_t v = 0; v < cut_at_.size(); ++v) {
      if (stays_[v]) continue;
      Pull best;
      for (const Index e : cut_at_[v]) {
        const Edge edge = edges_[at(e)];
        const bool first = at(edge.first) == v;
        const Index other = first ? edge.second : edge.first;
        if (value(other) == 0.0) continue;
        const double share = first ? share_of(edge) : 1.0 - share_of(edge);
        const double distance = share * (lattice_.points[at(other)] - lattice_.points[v]).norm();
        if (share < snap_share(static_cast<Index>(v), other) && distance < best.distance)
          best = {distance, e};
      }
      if (best.other < 0) continue;
      grid_.x[v] = cut_place(edges_[at(best.other)]);
      values_[v] = 0.0;
    }
  }

  Vec3 cut_place(const Edge& e) const {
    const double share = share_of(e);
    return (1.0 - share) * lattice_.points[at(e.first)] + share * lattice_.points[at(e.second)];
  }

  void add_cuts() {
    cuts_.clear();
    for (const Edge& e : edges_) {
      const bool whole = value(e.first) == 0.0 || value(e.second) == 0.0;
      cuts_.push_back(whole ? -1 : static_cast<Index>(grid_.x.size()));
      if (whole) continue;
      const double share = std::clamp(share_of(e), kLeastShare, 1.0 - kLeastShare);
      const Vec3 &a = lattice_.points[at(e.first)], &b = lattice_.points[at(e.second)];
      grid_.x.push_back((1.0 - share) * a + share * b);
      regular_.push_back(0.5 * (a + b));
    }
  }

  Index cut(Index a, Index b) const {
    const Edge e{std::min(a, b), std::max(a, b)};
    return cuts_[static_cast<std::size_t>(std::lower_bound(edges_.begin(), edges_.end(), e) -
                                          edges_.begin())];
  }

  // turned as it would be with points where the lattice has them and cuts midway, so that elements
  // agree on their faces; what has no volume as it is, is folded
  void add(Index a, Index b, Index c, Index d) {
    const auto volume = [](const std::vector<Vec3>& x, const Tet& t) {
      return volume6(x[at(t[0])], x[at(t[1])], x[at(t[2])], x[at(t[3])]);
    };
    Tet t{a, b, c, d};
    if (volume(regular_, t) < 0.0) std::swap(t[2], t[3]);
    grid_.tets.push_back(t);
    if (volume(grid_.x, t) <= 0.0) folded_.insert(folded_.end(), t.begin(), t.end());
  }

  // the part of a lattice element inside; diagonals of cut faces start from the corner that comes
  // first, so that two elements agree on them
  void fill(const Tet& tet) {
    std::array<Index, 4> in{}, zero{}, out{};
    std::size_t n_in = 0, n_zero = 0, n_out = 0;
    for (const Index v : tet) {
      if (value(v) > 0.0) in[n_in++] = v;
      if (value(v) == 0.0) zero[n_zero++] = v;
      if (value(v) < 0.0) out[n_out++] = v;
    }
    std::sort(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(n_in),
              [&](Index a, Index b) { return comes_first(a, b); });
    const auto [a, b, c, d] = in;
    const Index n = out[0], m = out[1];
    if (n_in == 0) return;
    if (n_out == 0) {
      add(tet[0], tet[1], tet[2], tet[3]);
    } else if (n_in == 1) {
      std::array<Index, 3> far{};
      for (std::size_t k = 0; k < 3; ++k) far[k] = k < n_out ? cut(a, out[k]) : zero[k - n_out];
      add(a, far[0], far[1], far[2]);
    } else if (n_in == 2 && n_out == 1) {
      add(a, b, cut(b, n), zero[0]);
      add(a, cut(b, n), cut(a, n), zero[0]);
    } else if (n_in == 2) {
      add(a, b, cut(b, n), cut(b, m));
      fill_wedge(a, {cut(a, n), cut(a, m), cut(b, m), cut(b, n)});
    } else {
      add(a, b, c, cut(c, n));
      add(a, b, cut(b, n), cut(c, n));
      add(a, cut(a, n), cut(b, n), cut(c, n));
    }
  }

  void fill_wedge(Index tip, const std::array<Index, 4>& quad) {
    const auto length = [&](std::size_t i, std::size_t j) {
      return (grid_.x[at(quad[i])] - grid_.x[at(quad[j])]).squaredNorm();
    };
    const std::size_t k = length(0, 2) <= length(1, 3) ? 0 : 1;
    add(tip, quad[k], quad[k + 1], quad[k + 2]);
    add(tip, quad[k], quad[k + 2], quad[(k + 3) % 4]);
  }

  bool comes_first(Index a, Index b) const {
    if (lattice_.is_centre[at(a)] != lattice_.is_centre[at(b)]) return lattice_.is_centre[at(a)];
    return a < b;
  }

  const Lattice& lattice_;
  std::vector<double> original_, values_;  // positive inside, mm
  std::vector<char> stays_;
  std::vector<Edge> edges_;                 // cut by the surface, sorted
  std::vector<std::vector<Index>> cut_at_;  // by the lattice points at their ends
  std::vector<Index> cuts_;                 // node on each of them
  TetGrid grid_;
  std::vector<Vec3> regular_;  // nodes where the lattice has them, and cuts midway
  std::vector<Index> folded_;  // corners of elements without volume
};

using Face = std::array<Index, 3>;

// opposite faces of the elements around v, corners ascending
std::vector<Face> link_of(const TetGrid& grid, Index v) {
  std::vector<Face> link;
  link.reserve(grid.around[at(v)].size());
  for (const Index t : grid.around[at(v)]) {
    Face f{};
    std::size_t n = 0;
    for (const Index u : grid.tets[at(t)])
      if (u != v) f[n++] = u;
    std::sort(f.begin(), f.end());
    link.push_back(f);
  }
  return link;
}

// what a node is looked at with, kept for the next one
struct LinkLists {
  std::vector<std::pair<Edge, std::size_t>> edges;
  std::vector<Index> nodes;
  std::vector<std::size_t> piece;
};

// a disc or a sphere: connected by edges, and of the right Euler characteristic
bool is_simple(const std::vector<Face>& link, LinkLists& lists) {
  auto& [edges, nodes, piece] = lists;
  edges.clear();
  nodes.clear();
  for (std::size_t f = 0; f < link.size(); ++f) {
    const auto [a, b, c] = link[f];
    for (const Edge& e : {Edge{a, b}, Edge{b, c}, Edge{a, c}}) edges.emplace_back(e, f);
    nodes.insert(nodes.end(), link[f].begin(), link[f].end());
  }
  std::sort(edges.begin(), edges.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  piece.resize(link.size());
  for (std::size_t f = 0; f < piece.size(); ++f) piece[f] = f;
  std::size_t n_edges = 0, n_pairs = 0, n_pieces = link.size();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (i == 0 || edges[i].first != edges[i - 1].first) {
      ++n_edges;
      continue;
    }
    ++n_pairs;
    const std::size_t from = piece[edges[i].second], to = piece[edges[i - 1].second];
    if (from == to) continue;
    std::replace(piece.begin(), piece.end(), from, to);
    --n_pieces;
  }
  const auto euler = static_cast<std::ptrdiff_t>(nodes.size() + link.size()) -
                     static_cast<std::ptrdiff_t>(n_edges);
  const bool closed = n_pairs == n_edges;
  return n_pieces == 1 && euler == (closed ? 2 : 1);
}

}  // namespace

std::vector<Index> pinched_nodes(const TetGrid& grid) {
  std::vector<Index> found;
  LinkLists lists;
  for (std::size_t v = 0; v < grid.x.size(); ++v) {
    if (grid.kinds[v] == NodeKind::inside || grid.around[v].empty()) continue;
    if (!is_simple(link_of(grid, static_cast<Index>(v)), lists))
      found.push_back(static_cast<Index>(v));
  }
  return found;
}

TetGrid stuffed(const Lattice& lattice, const TriangleTree& surface) {
  Stuffing stuffing(lattice, surface);
  TetGrid grid = stuffing.build();
  for (;;) {
    // where nothing moves the parts of a lattice element have volume
    const bool folded = stuffing.hold(stuffing.folded());
    if (!stuffing.hold(pinched_nodes(grid)) && !folded) break;
    grid = stuffing.build();
  }
  return grid;
}

}  // namespace coxa::meshing
