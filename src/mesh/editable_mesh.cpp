#include "editable_mesh.h"

#include <coxa/core/error.h>

#include <Eigen/Geometry>

#include <algorithm>

namespace coxa {
namespace {

// a triangle counts as turned over when its normal swings by more than the angle of this cosine
constexpr double kMaxTurnCosine = 0.2;

bool has(const EditableMesh::Triangle& t, Index v) { return t[0] == v || t[1] == v || t[2] == v; }

// the triangle's corners starting with v
EditableMesh::Triangle starting_at(const EditableMesh::Triangle& t, Index v) {
  if (t[0] == v) return t;
  return t[1] == v ? EditableMesh::Triangle{t[1], t[2], t[0]}
                   : EditableMesh::Triangle{t[2], t[0], t[1]};
}

}  // namespace

EditableMesh::EditableMesh(const TriMesh& mesh)
    : points_(static_cast<std::size_t>(mesh.n_vertices())),
      triangles_(static_cast<std::size_t>(mesh.n_triangles())),
      around_(static_cast<std::size_t>(mesh.n_vertices())),
      n_alive_(mesh.n_triangles()) {
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    points_[static_cast<std::size_t>(v)] = mesh.points.row(v);
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    for (int k = 0; k < 3; ++k) {
      triangles_[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)] = mesh.triangles(t, k);
      around_[static_cast<std::size_t>(mesh.triangles(t, k))].push_back(t);
    }
}

std::vector<Index> EditableMesh::neighbours(Index v) const {
  std::vector<Index> found;
  for (Index t : around(v)) found.push_back(starting_at(triangle(t), v)[1]);  // closed: each once
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::array<Index, 2>> EditableMesh::edges() const {
  std::vector<std::array<Index, 2>> found;
  for (Index a = 0; a < n_vertices(); ++a)
    for (Index b : neighbours(a))
      if (a < b) found.push_back({a, b});
  return found;
}

std::array<Index, 2> EditableMesh::opposite(Index a, Index b) const {
  std::array<Index, 2> found{-1, -1};
  for (Index t : around(a)) {
    const Triangle corners = starting_at(triangle(t), a);
    if (corners[1] == b) found[0] = corners[2];
    if (corners[2] == b) found[1] = corners[1];
  }
  return found;
}

Vec3 EditableMesh::area_vector(Index t) const {
  const auto [a, b, c] = triangle(t);
  return 0.5 * (point(b) - point(a)).cross(point(c) - point(a));
}

Vec3 EditableMesh::vertex_normal(Index v) const {
  Vec3 sum = Vec3::Zero();
  for (Index t : around(v)) sum += area_vector(t);
  return sum.normalized();
}

bool EditableMesh::turns_over(Index t, Index v, const Vec3& p) const {
  const Triangle corners = starting_at(triangle(t), v);
  const Vec3 b = point(corners[1]), c = point(corners[2]);
  const Vec3 before = (b - point(v)).cross(c - point(v)), after = (b - p).cross(c - p);
  // a triangle may get out of having no area, but not into it
  return after.dot(before) < kMaxTurnCosine * after.norm() * before.norm() ||
         after.squaredNorm() <=
             1e-20 * (c - b).squaredNorm() * ((b - p).squaredNorm() + (c - p).squaredNorm());
}

bool EditableMesh::can_collapse(Index a, Index b, const Vec3& p) const {
  // link condition: the two ends share exactly the two vertices opposite their edge
  const std::vector<Index> of_a = neighbours(a), of_b = neighbours(b);
  std::vector<Index> shared;
  std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                        std::back_inserter(shared));
  if (shared.size() != 2 || degree(shared[0]) <= 3 || degree(shared[1]) <= 3) return false;
  for (Index t : around(a))
    if (!has(triangle(t), b) && turns_over(t, a, p)) return false;
  for (Index t : around(b))
    if (!has(triangle(t), a) && turns_over(t, b, p)) return false;
  return true;
}

void EditableMesh::collapse(Index a, Index b, const Vec3& p) {
  const std::vector<Index> moving = around(b);
  for (Index t : moving) {
    if (has(triangle(t), a)) {
      for (Index v : triangle(t)) detach(v, t);
      triangles_[static_cast<std::size_t>(t)] = {0, 0, 0};
      --n_alive_;
    } else {
      replace(t, b, a);
    }
  }
  around_[static_cast<std::size_t>(b)].clear();
  move(a, p);
}

Index EditableMesh::split(Index a, Index b, const Vec3& p) {
  const Index middle = n_vertices();
  points_.push_back(p);
  around_.emplace_back();
  const std::vector<Index> candidates = around(a);
  for (Index t : candidates) {
    if (!has(triangle(t), b)) continue;
    // the half at a keeps the number, the half at b gets a new one
    const auto half = static_cast<Index>(triangles_.size());
    triangles_.push_back(triangle(t));
    for (Index v : triangle(t)) around_[static_cast<std::size_t>(v)].push_back(half);
    replace(t, b, middle);
    replace(half, a, middle);
    ++n_alive_;
  }
  return middle;
}

bool EditableMesh::can_flip(Index a, Index b) const {
  const auto [left, right] = opposite(a, b);
  if (degree(a) <= 3 || degree(b) <= 3 || left == right) return false;
  const std::vector<Index> of_left = neighbours(left);
  if (std::binary_search(of_left.begin(), of_left.end(), right)) return false;
  const Vec3 A = point(a), B = point(b), L = point(left), R = point(right);
  const Vec3 before = (B - A).cross(L - A) + (R - A).cross(B - A);
  const Vec3 one = (R - A).cross(L - A), two = (L - B).cross(R - B);
  const double limit = kMaxTurnCosine * before.norm();
  return one.dot(before) > limit * one.norm() && two.dot(before) > limit * two.norm();
}

void EditableMesh::flip(Index a, Index b) {
  const auto [left, right] = opposite(a, b);
  std::array<Index, 2> pair{};
  for (Index t : around(a))
    if (has(triangle(t), b)) pair[has(triangle(t), left) ? 0 : 1] = t;
  replace(pair[0], b, right);  // a, b, left  -> a, right, left
  replace(pair[1], a, left);   // b, a, right -> b, left, right
}

bool EditableMesh::can_move(Index v, const Vec3& p) const {
  return std::none_of(around(v).begin(), around(v).end(),
                      [&](Index t) { return turns_over(t, v, p); });
}

void EditableMesh::replace(Index t, Index from, Index to) {
  for (Index& v : triangles_[static_cast<std::size_t>(t)])
    if (v == from) v = to;
  detach(from, t);
  around_[static_cast<std::size_t>(to)].push_back(t);
}

void EditableMesh::detach(Index v, Index t) {
  auto& list = around_[static_cast<std::size_t>(v)];
  list.erase(std::remove(list.begin(), list.end(), t), list.end());
}

TriMesh EditableMesh::result() const {
  std::vector<Index> number(points_.size(), 0);
  Index count = 0;
  for (Index v = 0; v < n_vertices(); ++v)
    if (alive(v)) number[static_cast<std::size_t>(v)] = count++;
  TriMesh mesh;
  mesh.points.resize(count, 3);
  for (Index v = 0; v < n_vertices(); ++v)
    if (alive(v)) mesh.points.row(number[static_cast<std::size_t>(v)]) = point(v);
  mesh.triangles.resize(n_alive_, 3);
  Index row = 0;
  for (const Triangle& t : triangles_) {
    if (t[0] == t[1]) continue;
    for (std::size_t k = 0; k < 3; ++k)
      mesh.triangles(row, static_cast<Index>(k)) = number[static_cast<std::size_t>(t[k])];
    ++row;
  }
  return mesh;
}

}  // namespace coxa
