#include <coxa/mesh/remesh.h>

#include "editable_mesh.h"

#include <coxa/core/error.h>
#include <coxa/mesh/topology.h>

#include <Eigen/Eigenvalues>

#include <queue>
#include <tuple>
#include <vector>

namespace coxa {
namespace {

// x^T A x - 2 b^T x + c, about an origin at the mesh's first vertex
struct Quadric {
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  double c = 0.0;

  void add_plane(const Vec3& normal, double offset, double weight) {
    A += weight * normal * normal.transpose();
    b += weight * offset * normal;
    c += weight * offset * offset;
  }
  void add_point(const Vec3& p, double weight) {
    A.diagonal().array() += weight;
    b += weight * p;
    c += weight * p.squaredNorm();
  }
  Quadric operator+(const Quadric& other) const { return {A + other.A, b + other.b, c + other.c}; }
  double operator()(const Vec3& x) const { return x.dot(A * x) - 2.0 * b.dot(x) + c; }

  // least value, moving away from `start` only along directions that the quadric feels
  Vec3 minimum(const Vec3& start) const {
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(A);
    const Vec3 pull = axes.eigenvectors().transpose() * (b - A * start);
    Vec3 step = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (axes.eigenvalues()[k] > 1e-3 * axes.eigenvalues()[2])
        step += pull[k] / axes.eigenvalues()[k] * axes.eigenvectors().col(k);
    return start + step;
  }
};

struct Candidate {
  double cost;
  Index a, b;
  int stamp;
  // priority_queue puts the greatest first
  bool operator<(const Candidate& other) const {
    return std::tie(cost, a, b) > std::tie(other.cost, other.a, other.b);
  }
};

class Decimator {
 public:
  Decimator(const TriMesh& mesh, const DecimateOptions& options)
      : mesh_(mesh),
        kept_(options.kept),
        origin_(mesh.points.row(0)),
        quadrics_(static_cast<std::size_t>(mesh.n_vertices())),
        stamps_(static_cast<std::size_t>(mesh.n_vertices()), 0) {
    for (Index v = 0; v < mesh.n_vertices(); ++v)
      for (Index t : mesh_.around(v)) add_triangle(v, t, options.evenness);
  }

  TriMesh run(Index n_triangles) {
    // edges refused for a fold get another chance once everything else has been collapsed
    Index before = 0;
    while (mesh_.n_triangles() > n_triangles && mesh_.n_triangles() != before) {
      before = mesh_.n_triangles();
      for (const auto& [a, b] : mesh_.edges()) push(a, b);
      collapse_down_to(n_triangles);
    }
    return mesh_.result();
  }

 private:
  void collapse_down_to(Index n_triangles) {
    for (; mesh_.n_triangles() > n_triangles && !queue_.empty(); queue_.pop()) {
      const Candidate next = queue_.top();
      if (next.stamp != stamp(next.a, next.b) || !mesh_.alive(next.a) || !mesh_.alive(next.b))
        continue;
      const Vec3 p = target(next.a, next.b);
      if (mesh_.can_collapse(next.a, next.b, p)) collapse(next.a, next.b, p);
    }
    queue_ = {};
  }

  void add_triangle(Index v, Index t, double evenness) {
    const Vec3 area_vector = mesh_.area_vector(t);
    const double area = area_vector.norm();
    if (!(area > 0.0)) return;
    const Vec3 normal = area_vector / area, p = mesh_.point(v) - origin_;
    Quadric& quadric = quadrics_[static_cast<std::size_t>(v)];
    quadric.add_plane(normal, normal.dot(p), area / 3.0);
    quadric.add_point(p, evenness * area / 3.0);
  }

  Quadric sum(Index a, Index b) const {
    return quadrics_[static_cast<std::size_t>(a)] + quadrics_[static_cast<std::size_t>(b)];
  }
  Vec3 target(Index a, Index b) const {
    const Vec3 middle = 0.5 * (mesh_.point(a) + mesh_.point(b)) - origin_;
    const Vec3 p = sum(a, b).minimum(middle);
    // a minimum far away belongs to nearly parallel planes
    const double reach = (mesh_.point(a) - mesh_.point(b)).norm();
    return ((p - middle).norm() <= reach ? p : middle) + origin_;
  }
  int stamp(Index a, Index b) const {
    return stamps_[static_cast<std::size_t>(a)] + stamps_[static_cast<std::size_t>(b)];
  }
  bool is_kept(Index v) const { return !kept_.empty() && kept_[static_cast<std::size_t>(v)]; }
  void push(Index a, Index b) {
    if (is_kept(a) || is_kept(b)) return;
    queue_.push({sum(a, b)(target(a, b) - origin_), a, b, stamp(a, b)});
  }

  void collapse(Index a, Index b, const Vec3& p) {
    quadrics_[static_cast<std::size_t>(a)] = sum(a, b);
    mesh_.collapse(a, b, p);
    ++stamps_[static_cast<std::size_t>(a)];
    for (Index v : mesh_.neighbours(a)) push(std::min(a, v), std::max(a, v));
  }

  EditableMesh mesh_;
  const std::vector<bool>& kept_;
  Vec3 origin_;
  std::vector<Quadric> quadrics_;
  std::vector<int> stamps_;
  std::priority_queue<Candidate> queue_;
};

}  // namespace

TriMesh decimate(const TriMesh& mesh, const DecimateOptions& options) {
  require(options.n_triangles >= 4,
          "decimate: a closed surface has at least 4 triangles, asked for ", options.n_triangles);
  require(options.evenness >= 0.0, "decimate: evenness must not be negative, got ",
          options.evenness);
  require(options.kept.empty() || std::ssize(options.kept) == mesh.n_vertices(),
          "decimate: ", options.kept.size(), " marks of kept vertices for ", mesh.n_vertices(),
          " vertices");
  require_closed_manifold(mesh, "decimate");
  return Decimator(mesh, options).run(options.n_triangles);
}

}  // namespace coxa
