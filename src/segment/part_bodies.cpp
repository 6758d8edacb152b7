#include <coxa/segment/part_bodies.h>

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/unfold.h>
#include <coxa/mesh/validate.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa::segment {
namespace {

// mm kept between surfaces, so that their flat triangles do not cross between the points looked at
constexpr double kGap = 0.1;
// mm: deeper points are looked for no more; nearer ones than kNear are looked at in every round
constexpr double kReach = 20.0, kNear = 2.0;
// mm: what is deeper is no overlap of neighbours but a body in a wrong place; pushed out to the
// nearest side it would tear
constexpr double kDeepest = 3.0;
// rounds of pushing before points are looked for anew, and how often that is done
constexpr int kRounds = 25, kSearches = 6;
// passes over the neighbours by which ways are evened, in so many first searches
constexpr int kEvening = 4, kEvenedSearches = 3;
// places of a triangle that are looked at: corners, middles of its edges, its middle
constexpr int kPlaces = 7;

const std::array<Vec3, kPlaces>& places() {
  static const std::array<Vec3, kPlaces> all{
      Vec3(1, 0, 0),   Vec3(0, 1, 0),   Vec3(0, 0, 1),         Vec3(.5, .5, 0),
      Vec3(0, .5, .5), Vec3(.5, 0, .5), Vec3(1., 1., 1.) / 3.0};
  return all;
}

/// A place of body a near body b.
struct Probe {
  std::size_t a = 0, b = 0;
  Index triangle = 0;
  int place = 0;
};

/// How much a place must move out of the other body, and where that is.
struct Push {
  double need = 0.0;  // mm, 0: nothing
  double depth = 0.0;
  Vec3 out = Vec3::Zero();
  NearestPoint near;
};

class Bodies {
 public:
  Bodies(const std::vector<TriMesh*>& soft, const std::vector<const TriMesh*>& firm)
      : soft_(soft), n_soft_(soft.size()) {
    for (const TriMesh* mesh : soft) {
      meshes_.push_back(mesh);
      neighbours_.push_back(vertex_neighbours(*mesh));
      start_.push_back(mesh->points);
    }
    meshes_.insert(meshes_.end(), firm.begin(), firm.end());
    for (const TriMesh* mesh : meshes_) trees_.emplace_back(mesh->points, mesh->triangles);
  }

  /// Every place of a soft body, or of a firm one in a soft one, that is inside or near another.
  std::vector<Probe> probes() const {
    std::vector<Probe> found;
    for (std::size_t a = 0; a < meshes_.size(); ++a) {
      for (std::size_t b = 0; b < meshes_.size(); ++b) {
        if (a == b || (a >= n_soft_ && b >= n_soft_) || !boxes_meet(a, b)) continue;
        append_probes(a, b, found);
      }
    }
    return found;
  }

  /// One round for all probes, the ways evened over `evening` rings of neighbours.
  /// @returns the greatest depth before it, of what is pushed
  double push(const std::vector<Probe>& probes, int evening) {
    std::vector<Push> pushes(probes.size());
    parallel_for(static_cast<std::int64_t>(probes.size()), [&](Index i) {
      const auto k = static_cast<std::size_t>(i);
      pushes[k] = push_of(probes[k]);
    });
    double deepest = 0.0;
    clear_moves();
    for (std::size_t k = 0; k < probes.size(); ++k) {
      if (pushes[k].need <= 0.0) continue;
      deepest = std::max(deepest, pushes[k].depth);
      add(probes[k], pushes[k]);
    }
    move(evening);
    return deepest;
  }

  /// Greatest depth as it is.
  double deepest() const {
    double depth = 0.0;
    for (const Probe& probe : probes()) depth = std::max(depth, push_of(probe).depth);
    return depth;
  }

  /// Takes out folds that pushing left.
  void unfold() {
    for (std::size_t a = 0; a < n_soft_; ++a) {
      if (touched_[a]) update_unfolded(*soft_[a]);
      trees_[a].update_points(soft_[a]->points);
    }
  }

 private:
  bool boxes_meet(std::size_t a, std::size_t b) const {
    const Points &p = meshes_[a]->points, &q = meshes_[b]->points;
    const auto low = p.colwise().minCoeff().cwiseMax(q.colwise().minCoeff()).eval();
    const auto high = p.colwise().maxCoeff().cwiseMin(q.colwise().maxCoeff()).eval();
    return ((low - high).array() <= kNear).all();
  }
  Vec3 at(const Probe& probe) const {
    const TriMesh& mesh = *meshes_[probe.a];
    const Vec3& w = places()[static_cast<std::size_t>(probe.place)];
    Vec3 p = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      p += w[k] * mesh.points.row(mesh.triangles(probe.triangle, k)).transpose();
    return p;
  }
  void append_probes(std::size_t a, std::size_t b, std::vector<Probe>& found) const {
    const Vec3 low = meshes_[b]->points.colwise().minCoeff().transpose().array() - kNear;
    const Vec3 high = meshes_[b]->points.colwise().maxCoeff().transpose().array() + kNear;
    const Index n = meshes_[a]->n_triangles();
    std::vector<std::uint8_t> close(static_cast<std::size_t>(n) * kPlaces, 0);
    parallel_for(n, [&](Index t) {
      for (int k = 0; k < kPlaces; ++k) {
        const Vec3 p = at({a, b, t, k});
        if ((p.array() < low.array()).any() || (p.array() > high.array()).any()) continue;
        const auto near = trees_[b].nearest_within(p, kReach);
        if (!near) continue;
        const double height = trees_[b].sign_at(p, *near) * std::sqrt(near->squared_distance);
        close[static_cast<std::size_t>(t) * kPlaces + static_cast<std::size_t>(k)] = height < kNear;
      }
    });
    for (Index t = 0; t < n; ++t)
      for (int k = 0; k < kPlaces; ++k)
        if (close[static_cast<std::size_t>(t) * kPlaces + static_cast<std::size_t>(k)] != 0)
          found.push_back({a, b, t, k});
  }
  Push push_of(const Probe& probe) const {
    const Vec3 p = at(probe);
    const TriangleTree& tree = trees_[probe.b];
    const auto near = tree.nearest_within(p, kReach);
    Push push;
    if (!near) return push;
    const double distance = std::sqrt(near->squared_distance), sign = tree.sign_at(p, *near);
    push.depth = std::max(0.0, -sign * distance);
    if (sign * distance >= kGap || distance < 1e-9 || push.depth > kDeepest) return push;
    push.need = kGap - sign * distance;
    push.out = sign / distance * (p - near->point);
    push.near = *near;
    return push;
  }
  void clear_moves() {
    moves_.assign(n_soft_, {});
    weights_.assign(n_soft_, {});
    touched_.resize(n_soft_, false);
    for (std::size_t a = 0; a < n_soft_; ++a) {
      moves_[a] = Points::Zero(soft_[a]->n_vertices(), 3);
      weights_[a] = VecX::Zero(soft_[a]->n_vertices());
    }
  }
  void add(std::size_t body, Index triangle, const Vec3& weights, const Vec3& way) {
    if (body >= n_soft_) return;
    for (int k = 0; k < 3; ++k) {
      const Index v = meshes_[body]->triangles(triangle, k);
      moves_[body].row(v) += weights[k] * way;
      weights_[body][v] += weights[k];
    }
  }
  void add(const Probe& probe, const Push& push) {
    const double share = probe.a < n_soft_ && probe.b < n_soft_ ? 0.5 : 1.0;
    const Vec3 way = share * push.need * push.out;
    add(probe.a, probe.triangle, places()[static_cast<std::size_t>(probe.place)], way);
    add(probe.b, push.near.triangle, push.near.barycentric, -way);
  }
  /// What neighbours do is done in part by those who need not: folds do not arise.
  Points evened_ways(std::size_t a, int evening) const {
    const Index n = soft_[a]->n_vertices();
    Points ways = Points::Zero(n, 3);
    for (Index v = 0; v < n; ++v)
      if (weights_[a][v] > 0.0) ways.row(v) = moves_[a].row(v) / weights_[a][v];
    for (int pass = 0; pass < evening; ++pass) {
      const Points before = ways;
      for (Index v = 0; v < n; ++v) {
        double count = 1.0;
        for (const Index w : neighbours_[a][v]) ways.row(v) += before.row(w), count += 1.0;
        ways.row(v) /= count;
      }
    }
    return ways;
  }
  void move(int evening) {
    for (std::size_t a = 0; a < n_soft_; ++a) {
      if ((weights_[a].array() > 0.0).any()) {
        soft_[a]->points += evened_ways(a, evening);
        for (Index v = 0; v < soft_[a]->n_vertices(); ++v) {
          const Vec3 gone = (soft_[a]->points.row(v) - start_[a].row(v)).transpose();
          if (gone.norm() > kDeepest)
            soft_[a]->points.row(v) = start_[a].row(v) + kDeepest * gone.normalized().transpose();
        }
        touched_[a] = true;
      }
      trees_[a].update_points(soft_[a]->points);
    }
  }

  std::vector<TriMesh*> soft_;
  std::size_t n_soft_;
  std::vector<const TriMesh*> meshes_;  // soft ones first
  std::vector<TriangleTree> trees_;
  std::vector<Adjacency> neighbours_;
  std::vector<Points> start_, moves_;
  std::vector<VecX> weights_;
  std::vector<bool> touched_;
};

/// A surface that folds now and did not before is taken back as it was: overlap is the lesser evil.
void restore_broken(const std::vector<TriMesh*>& soft, const std::vector<Points>& before) {
  for (std::size_t a = 0; a < soft.size(); ++a) {
    if (soft[a]->points == before[a] || self_intersections(*soft[a]).empty()) continue;
    const TriMesh old{before[a], soft[a]->triangles};
    if (!self_intersections(old).empty()) continue;
    soft[a]->points = before[a];
  }
}

}  // namespace

double update_parted(const std::vector<TriMesh*>& soft, const std::vector<const TriMesh*>& firm,
                     double tolerance, const Monitor& monitor) {
  Bodies bodies(soft, firm);
  std::vector<Points> before;
  for (const TriMesh* mesh : soft) before.push_back(mesh->points);
  for (int search = 0; search < kSearches; ++search) {
    monitor.check_cancelled();
    const std::vector<Probe> probes = bodies.probes();
    if (bodies.push(probes, 0) <= tolerance) break;
    const int evening = search < kEvenedSearches ? kEvening : 0;
    for (int round = 1; round < kRounds; ++round) {
      if (bodies.push(probes, evening) <= tolerance) break;
    }
    bodies.unfold();
  }
  restore_broken(soft, before);
  return Bodies(soft, firm).deepest();
}

}  // namespace coxa::segment
