#include "rim_search.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/vertex_normals.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "interpolated.h"

namespace coxa::segment {
namespace {

// places tried across the rim, mm apart
constexpr double kStep = 0.5, kLongestStep = 1.0;
// cost of a place d mm away, per mm of rim: kFar d²; against 1 for a millimetre of certain ground
constexpr double kFar = 0.045;
// cost of neighbours l mm apart that go d and e: kUneven (d - e)² / l
constexpr double kUneven = 0.5;
// the border's move fades over this length inside the sheet, mm
constexpr double kFading = 8.0;
// rounds of evening where triangles have turned over
constexpr int kEvening = 30;

/// A patch that answers where a point's foot is and what holds there.
class Ground {
 public:
  Ground(const HostPatch& patch, const VecX& score)
      : patch_(patch), score_(score), tree_(patch.mesh.points, patch.mesh.triangles) {}
  NearestPoint foot(const Vec3& p) const { return tree_.nearest(p); }
  Vec3 normal(const NearestPoint& at) const {
    return interpolated(patch_.normals, patch_.mesh.triangles, at).normalized();
  }
  double score(const NearestPoint& at) const {
    return interpolated(score_, patch_.mesh.triangles, at);
  }

 private:
  const HostPatch& patch_;
  const VecX& score_;
  TriangleTree tree_;
};

/// Places across the rim at one border vertex, from inside to outside, and the cost of each.
struct Way {
  Points places;
  VecX cost;
};

Way way_across(const Ground& ground, const Vec3& start, const Vec3& outward, Index n_each_way) {
  Way way{Points(2 * n_each_way + 1, 3), VecX::Zero(2 * n_each_way + 1)};
  const NearestPoint here = ground.foot(start);
  way.places.row(n_each_way) = here.point;
  for (const int sense : {1, -1}) {
    Vec3 direction = sense * outward;
    NearestPoint at = here;
    double cost = 0.0;
    for (Index k = 1; k <= n_each_way; ++k) {
      const Vec3 normal = ground.normal(at);
      direction = (direction - direction.dot(normal) * normal).normalized();
      const double before = ground.score(at);
      const NearestPoint next = ground.foot(at.point + kStep * direction);
      const Index place = n_each_way + sense * k;
      // a foot that jumps is on another fold of the host: the way ends here
      if ((next.point - at.point).norm() > kLongestStep) {
        for (Index rest = k; rest <= n_each_way; ++rest) {
          way.places.row(n_each_way + sense * rest) = at.point;
          way.cost[n_each_way + sense * rest] = kInfinity;
        }
        break;
      }
      // outwards covered ground is won; inwards it is given up
      const double length = (next.point - at.point).norm();
      cost -= sense * length * 0.5 * (before + ground.score(next));
      at = next;
      const double far = k * kStep;
      way.places.row(place) = at.point;
      way.cost[place] = cost + kFar * far * far;
    }
  }
  return way;
}

/// Places along a closed chain of least total cost. The chain is walked twice and the places of the
/// middle taken, which is the closed optimum but for rare ties.
std::vector<Index> best_chain(const std::vector<Way>& ways, const std::vector<double>& length) {
  const auto n = ways.size();
  const Index n_places = static_cast<Index>(ways.front().cost.size());
  std::vector<std::vector<Index>> from(2 * n,
                                       std::vector<Index>(static_cast<std::size_t>(n_places)));
  VecX total = VecX::Zero(n_places);
  for (std::size_t i = 0; i < 2 * n; ++i) {
    const std::size_t here = i % n, before = (i + n - 1) % n;
    // each vertex stands for half the rim to both sides
    const double share = 0.5 * (length[here] + length[before]);
    VecX next(n_places);
    for (Index p = 0; p < n_places; ++p) {
      double least = kInfinity;
      for (Index q = 0; q < n_places; ++q) {
        const double apart = kStep * (p - q);
        const double cost = total[q] + kUneven * apart * apart / length[before];
        if (cost >= least) continue;
        least = cost;
        from[i][static_cast<std::size_t>(p)] = q;
      }
      next[p] = least + share * ways[here].cost[p];
    }
    total = next;
  }
  Index place = 0;
  total.minCoeff(&place);
  std::vector<Index> chosen(n);
  for (std::size_t i = 2 * n; i-- > 0;) {
    const std::size_t middle = n / 2;
    if (i >= middle && i < middle + n) chosen[i % n] = place;
    place = from[i][static_cast<std::size_t>(place)];
  }
  return chosen;
}

/// Of each border edge (a, b): the triangle's third corner.
Vec3 inner_corner(const TriMesh& sheet, Index a, Index b) {
  for (Index t = 0; t < sheet.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (sheet.triangles(t, k) == a && sheet.triangles(t, (k + 1) % 3) == b)
        return sheet.points.row(sheet.triangles(t, (k + 2) % 3));
    }
  }
  return Vec3::Zero();
}

/// The place `n_further` beyond the one chosen, or as far as the way goes.
Index further(const Way& way, Index place, Index n_further) {
  for (Index k = 0; k < n_further && place + 1 < way.cost.size(); ++k) {
    if (!std::isfinite(way.cost[place + 1])) break;
    ++place;
  }
  return place;
}

/// New places of one loop's vertices, written into `moved`.
void update_loop(const TriMesh& sheet, const std::vector<Index>& loop, const Ground& ground,
                 const RimReach& reach, Points& moved) {
  const std::size_t n = loop.size();
  std::vector<Vec3> outward(n, Vec3::Zero());
  std::vector<double> length(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    const Vec3 a = sheet.points.row(loop[i]), b = sheet.points.row(loop[next]);
    const Vec3 along = b - a, to_inside = inner_corner(sheet, loop[i], loop[next]) - a;
    length[i] = std::max(along.norm(), 0.1 * kStep);
    const Vec3 across = to_inside - to_inside.dot(along) / along.squaredNorm() * along;
    outward[i] -= across.normalized() * length[i];
    outward[next] -= across.normalized() * length[i];
  }
  // a ragged border does not say where across is: neighbours do
  constexpr int kDirectionPasses = 3;
  for (int pass = 0; pass < kDirectionPasses; ++pass) {
    const std::vector<Vec3> before = outward;
    for (std::size_t i = 0; i < n; ++i)
      outward[i] = before[(i + n - 1) % n] + before[i] + before[(i + 1) % n];
  }
  const Index n_each_way = static_cast<Index>(std::lround(reach.search / kStep));
  const Index n_hidden = static_cast<Index>(std::lround(reach.hidden / kStep));
  std::vector<Way> ways(n);
  parallel_for(static_cast<std::int64_t>(n), [&](Index i) {
    const auto at = static_cast<std::size_t>(i);
    ways[at] = way_across(ground, sheet.points.row(loop[at]), outward[at], n_each_way);
  });
  const std::vector<Index> chosen = best_chain(ways, length);
  for (std::size_t i = 0; i < n; ++i)
    moved.row(loop[i]) = ways[i].places.row(further(ways[i], chosen[i], n_hidden));
}

/// Moves of all vertices from those of the border, fading inwards: (L + 1/fading²) u = 0.
Points spread(const TriMesh& sheet, const Points& border_moves,
              const std::vector<bool>& on_border) {
  const Adjacency neighbours = vertex_neighbours(sheet);
  const double edge = mean_edge_length(sheet);
  const double ground = (edge / kFading) * (edge / kFading);
  const Index n = sheet.n_vertices();
  std::vector<Eigen::Triplet<double>> entries;
  MatX right = MatX::Zero(n, 3);
  for (Index v = 0; v < n; ++v) {
    if (on_border[static_cast<std::size_t>(v)]) {
      entries.emplace_back(v, v, 1.0);
      right.row(v) = border_moves.row(v);
      continue;
    }
    entries.emplace_back(v, v, ground + static_cast<double>(neighbours[v].size()));
    for (const Index w : neighbours[v]) {
      if (on_border[static_cast<std::size_t>(w)])
        right.row(v) += border_moves.row(w);
      else
        entries.emplace_back(v, w, -1.0);
    }
  }
  Eigen::SparseMatrix<double> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(A);
  return solver.solve(right);
}

bool any_turned_over(const TriMesh& sheet, const Ground& ground, std::vector<bool>& about) {
  const Points normals = triangle_normals(sheet);
  about.assign(static_cast<std::size_t>(sheet.n_vertices()), false);
  bool any = false;
  for (Index t = 0; t < sheet.n_triangles(); ++t) {
    const Vec3 middle =
        (sheet.points.row(sheet.triangles(t, 0)) + sheet.points.row(sheet.triangles(t, 1)) +
         sheet.points.row(sheet.triangles(t, 2))) /
        3.0;
    if (ground.normal(ground.foot(middle)).dot(normals.row(t)) < 0.0) continue;
    any = true;
    for (int k = 0; k < 3; ++k) about[static_cast<std::size_t>(sheet.triangles(t, k))] = true;
  }
  return any;
}

/// Evens the sheet about triangles that have turned over, on the ground.
void update_evened(TriMesh& sheet, const Ground& ground, const std::vector<bool>& on_border) {
  const Adjacency neighbours = vertex_neighbours(sheet);
  std::vector<bool> about;
  for (int round = 0; round < kEvening && any_turned_over(sheet, ground, about); ++round) {
    std::vector<bool> wide = about;
    for (Index v = 0; v < sheet.n_vertices(); ++v) {
      for (const Index w : neighbours[v])
        if (about[static_cast<std::size_t>(w)]) wide[static_cast<std::size_t>(v)] = true;
    }
    const Points before = sheet.points;
    for (Index v = 0; v < sheet.n_vertices(); ++v) {
      const auto at = static_cast<std::size_t>(v);
      if (!wide[at]) continue;
      Vec3 sum = Vec3::Zero();
      double count = 0.0;
      for (const Index w : neighbours[v]) {
        // the border is evened along itself only
        if (on_border[at] && !on_border[static_cast<std::size_t>(w)]) continue;
        sum += before.row(w);
        count += 1.0;
      }
      const Vec3 goal = 0.5 * before.row(v).transpose() + 0.5 * sum / count;
      sheet.points.row(v) = ground.foot(goal).point;
    }
  }
}

}  // namespace

TriMesh sheet_to_rim(const TriMesh& sheet, const HostPatch& patch, const VecX& score,
                     const RimReach& reach) {
  const Ground ground(patch, score);
  Points moved = sheet.points;
  std::vector<bool> on_border(static_cast<std::size_t>(sheet.n_vertices()), false);
  for (const std::vector<Index>& loop : boundary_loops(sheet)) {
    update_loop(sheet, loop, ground, reach, moved);
    for (const Index v : loop) on_border[static_cast<std::size_t>(v)] = true;
  }
  TriMesh result = sheet;
  result.points += spread(sheet, moved - sheet.points, on_border);
  parallel_for(result.n_vertices(),
               [&](Index v) { result.points.row(v) = ground.foot(result.points.row(v)).point; });
  update_evened(result, ground, on_border);
  return result;
}

}  // namespace coxa::segment
