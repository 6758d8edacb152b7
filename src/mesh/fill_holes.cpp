#include "fill_holes.h"

#include <coxa/core/error.h>
#include <coxa/mesh/topology.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <utility>

namespace coxa {
namespace {

constexpr std::size_t kMaxLoop = 400;  // the search for the least area is cubic

double length_of(const TriMesh& mesh, const std::vector<Index>& loop) {
  double sum = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    sum += (mesh.points.row(loop[i]) - mesh.points.row(loop[(i + 1) % loop.size()])).norm();
  return sum;
}

// dynamic programme over sub-polygons: least area of the polygon cut off by the chord from i to j
class LeastArea {
 public:
  LeastArea(const TriMesh& mesh, const Adjacency& neighbours, std::vector<Index> loop)
      : mesh_(mesh),
        neighbours_(neighbours),
        loop_(std::move(loop)),
        n_(loop_.size()),
        area_(n_ * n_, 0.0),
        apex_(n_ * n_, 0) {
    for (std::size_t span = 2; span < n_; ++span)
      for (std::size_t i = 0; i + span < n_; ++i) choose_apex(i, i + span);
  }
  bool possible() const { return area_[n_ - 1] < kInfinity; }
  std::vector<std::array<Index, 3>> triangles() const {
    std::vector<std::array<Index, 3>> found;
    std::vector<std::pair<std::size_t, std::size_t>> pending{{0, n_ - 1}};
    while (!pending.empty()) {
      const auto [i, j] = pending.back();
      pending.pop_back();
      if (j - i < 2) continue;
      const std::size_t k = apex_[i * n_ + j];
      // the loop runs with the surface's triangles, so the patch runs against it
      found.push_back({loop_[j], loop_[k], loop_[i]});
      pending.insert(pending.end(), {{i, k}, {k, j}});
    }
    return found;
  }

 private:
  void choose_apex(std::size_t i, std::size_t j) {
    double best = kInfinity;
    const bool closing = i == 0 && j == n_ - 1;  // this chord is a border edge already
    if (closing || !joined(loop_[i], loop_[j]))
      for (std::size_t k = i + 1; k < j; ++k) {
        const double sum =
            area_[i * n_ + k] + area_[k * n_ + j] + triangle_area(loop_[i], loop_[k], loop_[j]);
        if (sum < best) {
          best = sum;
          apex_[i * n_ + j] = k;
        }
      }
    area_[i * n_ + j] = best;
  }
  bool joined(Index a, Index b) const {
    return std::binary_search(neighbours_[a].begin(), neighbours_[a].end(), b);
  }
  double triangle_area(Index a, Index b, Index c) const {
    const Vec3 p = mesh_.points.row(a), q = mesh_.points.row(b), r = mesh_.points.row(c);
    return 0.5 * (q - p).cross(r - p).norm();
  }

  const TriMesh& mesh_;
  const Adjacency& neighbours_;
  std::vector<Index> loop_;
  std::size_t n_;
  std::vector<double> area_;
  std::vector<std::size_t> apex_;
};

[[noreturn]] void refuse(const TriMesh& mesh, const std::vector<Index>& loop,
                         const std::string& why) {
  const Vec3 p = mesh.points.row(loop.front());
  fail(ErrorCode::bad_mesh, "the surface has a hole with a border of ", length_of(mesh, loop),
       " mm at (", p[0], ", ", p[1], ", ", p[2], ") mm, ", why);
}

}  // namespace

TriMesh fill_holes(const TriMesh& mesh, double max_hole, RepairReport& report) {
  const auto loops = boundary_loops(mesh);
  if (loops.empty()) return mesh;
  const Adjacency neighbours = vertex_neighbours(mesh);
  std::vector<std::array<Index, 3>> patches;
  for (const auto& loop : loops) {
    const double length = length_of(mesh, loop);
    if (length > max_hole)
      refuse(mesh, loop, join_text("longer than the ", max_hole, " mm that are filled"));
    if (loop.size() > kMaxLoop) refuse(mesh, loop, "with too many vertices to fill");
    const LeastArea patch(mesh, neighbours, loop);
    if (loop.size() < 3 || !patch.possible())
      refuse(mesh, loop, "which no new triangles can close without doubling an edge");
    const auto triangles = patch.triangles();
    patches.insert(patches.end(), triangles.begin(), triangles.end());
    ++report.filled_holes;
    report.longest_hole = std::max(report.longest_hole, length);
  }
  report.hole_triangles += static_cast<Index>(patches.size());
  TriMesh filled = mesh;
  filled.triangles.conservativeResize(mesh.n_triangles() + static_cast<Index>(patches.size()), 3);
  for (std::size_t i = 0; i < patches.size(); ++i)
    filled.triangles.row(mesh.n_triangles() + static_cast<Index>(i)) << patches[i][0],
        patches[i][1], patches[i][2];
  return filled;
}

}  // namespace coxa
