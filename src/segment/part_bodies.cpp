#include <coxa/segment/part_bodies.h>

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/unfold.h>
#include <coxa/mesh/validate.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "layer_sheet.h"

namespace coxa::segment {
namespace {

// rounds of pushing before points are looked for anew, and how often that is done
constexpr int kRounds = 25, kSearches = 6;
// passes over the neighbours by which ways are evened, in so many first searches
constexpr int kEvening = 4, kEvenedSearches = 3;
// places of a triangle that are looked at: of a lattice with so many steps along each side
constexpr int kSteps = 4, kPlaces = (kSteps + 1) * (kSteps + 2) / 2;

/// Barycentric coordinates of the places.
const std::array<Vec3, kPlaces>& places() {
  static const std::array<Vec3, kPlaces> all = [] {
    std::array<Vec3, kPlaces> lattice;
    std::size_t n = 0;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) lattice[n++] = Vec3(i, j, kSteps - i - j) / kSteps;
    return lattice;
  }();
  return all;
}

/// A place of body a near body b.
struct Probe {
  std::size_t a = 0, b = 0;
  Index triangle = 0;
  int place = 0;
};

/// Of a layer, by vertex: the one opposite, itself at the rim; empty for other bodies.
std::vector<Index> opposite_vertices(const SoftBody& body) {
  if (body.n_bone_side == 0) return {};
  std::vector<Index> opposite(static_cast<std::size_t>(body.mesh->n_vertices()));
  const std::vector<Index> of_sheet = sheet_of(*body.mesh, body.n_bone_side).opposite;
  for (std::size_t v = 0; v < of_sheet.size(); ++v) {
    opposite[v] = of_sheet[v];
    opposite[static_cast<std::size_t>(of_sheet[v])] = static_cast<Index>(v);
  }
  return opposite;
}

/// How much a place must move out of the other body, and where that is.
struct Push {
  double need = 0.0;  // mm, 0: nothing
  double depth = 0.0;
  Vec3 out = Vec3::Zero();
  NearestPoint near;
};

/// Where a surface folds that did not before it is taken back as it was, by more and more rings of
/// neighbours: overlap is the lesser evil.
void restore_folds(TriMesh& mesh, const Points& before, const Adjacency& neighbours) {
  if (!self_intersections({before, mesh.triangles}).empty()) return;
  std::vector<char> back(static_cast<std::size_t>(mesh.n_vertices()), 0);
  for (auto cuts = self_intersections(mesh); !cuts.empty(); cuts = self_intersections(mesh)) {
    for (const auto& cut : cuts)
      for (const Index t : cut)
        for (int k = 0; k < 3; ++k) back[static_cast<std::size_t>(mesh.triangles(t, k))] = 1;
    const std::vector<char> marked = back;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (marked[static_cast<std::size_t>(v)] == 0) continue;
      mesh.points.row(v) = before.row(v);
      for (const Index w : neighbours[v]) {
        back[static_cast<std::size_t>(w)] = 1;
        mesh.points.row(w) = before.row(w);
      }
    }
  }
}

class Bodies {
 public:
  Bodies(const std::vector<SoftBody>& soft, const std::vector<const TriMesh*>& firm,
         const Parting& parting)
      : parting_(parting), soft_(soft), n_soft_(soft.size()) {
    for (const SoftBody& body : soft) {
      meshes_.push_back(body.mesh);
      neighbours_.push_back(vertex_neighbours(*body.mesh));
      start_.push_back(body.mesh->points);
      opposite_.push_back(opposite_vertices(body));
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
      if (pushes[k].need <= 0.0 || is_through(probes[k], pushes[k])) continue;
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
      if (touched_[a] && !update_unfolded(*soft_[a].mesh))
        restore_folds(*soft_[a].mesh, start_[a], neighbours_[a]);
      trees_[a].update_points(soft_[a].mesh->points);
    }
  }

 private:
  bool boxes_meet(std::size_t a, std::size_t b) const {
    const Points &p = meshes_[a]->points, &q = meshes_[b]->points;
    const auto low = p.colwise().minCoeff().cwiseMax(q.colwise().minCoeff()).eval();
    const auto high = p.colwise().maxCoeff().cwiseMin(q.colwise().maxCoeff()).eval();
    return ((low - high).array() <= parting_.near).all();
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
    const Vec3 low = meshes_[b]->points.colwise().minCoeff().transpose().array() - parting_.near;
    const Vec3 high = meshes_[b]->points.colwise().maxCoeff().transpose().array() + parting_.near;
    const Index n = meshes_[a]->n_triangles();
    std::vector<std::uint8_t> close(static_cast<std::size_t>(n) * kPlaces, 0);
    parallel_for(n, [&](Index t) {
      for (int k = 0; k < kPlaces; ++k) {
        const Vec3 p = at({a, b, t, k});
        if ((p.array() < low.array()).any() || (p.array() > high.array()).any()) continue;
        const auto near = trees_[b].nearest_within(p, parting_.reach);
        if (!near) continue;
        const double height = trees_[b].sign_at(p, *near) * std::sqrt(near->squared_distance);
        close[static_cast<std::size_t>(t) * kPlaces + static_cast<std::size_t>(k)] =
            height < parting_.near;
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
    const auto near = tree.nearest_within(p, parting_.reach);
    Push push;
    if (!near) return push;
    const double distance = std::sqrt(near->squared_distance), sign = tree.sign_at(p, *near);
    push.depth = std::max(0.0, -sign * distance);
    if (sign * distance >= parting_.gap || distance < 1e-9 || push.depth > parting_.deepest)
      return push;
    push.need = parting_.gap - sign * distance;
    push.out = sign / distance * (p - near->point);
    push.near = *near;
    return push;
  }
  void clear_moves() {
    moves_.assign(n_soft_, {});
    weights_.assign(n_soft_, {});
    touched_.resize(n_soft_, false);
    for (std::size_t a = 0; a < n_soft_; ++a) {
      moves_[a] = Points::Zero(soft_[a].mesh->n_vertices(), 3);
      weights_[a] = VecX::Zero(soft_[a].mesh->n_vertices());
    }
  }
  /// A firm body in a layer, nearer to its far side: the way out is through its other side.
  bool is_through(const Probe& probe, const Push& push) const {
    return probe.b < n_soft_ && probe.a >= n_soft_ && soft_[probe.b].n_bone_side > 0 &&
           push.near.triangle >= soft_[probe.b].n_bone_side;
  }
  /// @param along whether vertices opposite go along
  void add(std::size_t body, Index triangle, const Vec3& weights, const Vec3& way, bool along) {
    if (body >= n_soft_) return;
    for (int k = 0; k < 3; ++k) {
      const Index v = meshes_[body]->triangles(triangle, k);
      add(body, v, weights[k], way);
      if (!along || opposite_[body].empty()) continue;
      const Index w = opposite_[body][static_cast<std::size_t>(v)];
      if (w != v) add(body, w, weights[k], way);
    }
  }
  void add(std::size_t body, Index vertex, double weight, const Vec3& way) {
    moves_[body].row(vertex) += weight * way;
    weights_[body][vertex] += weight;
  }
  void add(const Probe& probe, const Push& push) {
    const bool both = probe.a < n_soft_ && probe.b < n_soft_;
    const Vec3 way = (both ? 0.5 : 1.0) * push.need * push.out;
    add(probe.a, probe.triangle, places()[static_cast<std::size_t>(probe.place)], way, !both);
    add(probe.b, push.near.triangle, push.near.barycentric, -way, !both);
  }
  /// What neighbours do is done in part by those who need not: folds do not arise.
  Points evened_ways(std::size_t a, int evening) const {
    const Index n = soft_[a].mesh->n_vertices();
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
        soft_[a].mesh->points += evened_ways(a, evening);
        for (Index v = 0; v < soft_[a].mesh->n_vertices(); ++v) {
          const Vec3 gone = (soft_[a].mesh->points.row(v) - start_[a].row(v)).transpose();
          if (gone.norm() > parting_.deepest)
            soft_[a].mesh->points.row(v) =
                start_[a].row(v) + parting_.deepest * gone.normalized().transpose();
        }
        touched_[a] = true;
      }
      trees_[a].update_points(soft_[a].mesh->points);
    }
  }

  Parting parting_;
  std::vector<SoftBody> soft_;
  std::vector<std::vector<Index>> opposite_;
  std::size_t n_soft_;
  std::vector<const TriMesh*> meshes_;  // soft ones first
  std::vector<TriangleTree> trees_;
  std::vector<Adjacency> neighbours_;
  std::vector<Points> start_, moves_;
  std::vector<VecX> weights_;
  std::vector<bool> touched_;
};

}  // namespace

double update_parted(const std::vector<SoftBody>& soft, const std::vector<const TriMesh*>& firm,
                     const Parting& parting, const Monitor& monitor) {
  Bodies bodies(soft, firm, parting);
  for (int search = 0; search < kSearches; ++search) {
    monitor.check_cancelled();
    const std::vector<Probe> probes = bodies.probes();
    if (bodies.push(probes, 0) <= parting.tolerance) break;
    const int evening = search < kEvenedSearches ? kEvening : 0;
    for (int round = 1; round < kRounds; ++round) {
      if (bodies.push(probes, evening) <= parting.tolerance) break;
    }
    bodies.unfold();
  }
  return bodies.deepest();
}

}  // namespace coxa::segment
