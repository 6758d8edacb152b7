#include <coxa/segment/follow_mask.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/unfold.h>
#include <coxa/mesh/vertex_normals.h>
#include <coxa/mesh/voxelize.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa::segment {
namespace {

// voxels: standard deviation of the blur that makes borders smooth
constexpr double kBlur = 0.5;
// of the largest spacing: the way of a vertex whose voxel is wholly wrong; of the sum of blurred
// masks to either side of a border half
constexpr double kStep = 0.5;
constexpr int kRounds = 80;
// passes over the neighbours that even each round's displacement
constexpr int kEvening = 2;
// overlap and voxels at which nothing is left to do
constexpr double kGoodDice = 0.999;
// rounds without a better overlap after which the best is taken
constexpr int kPatience = 12;

// voxels about mask and surface
constexpr Index kMargin = 4;

/// A part of the grid with its part of the mask.
struct Window {
  Volume grid;
  std::vector<std::uint8_t> mask;
};

/// What holds both the mask and the surface.
Window window_about(const TriMesh& mesh, const std::vector<std::uint8_t>& mask,
                    const Volume& grid) {
  std::array<Index, 3> low = grid.size, high{-1, -1, -1};
  const auto widen = [&](const std::array<Index, 3>& at) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::clamp<Index>(at[a] - kMargin, 0, low[a]);
      high[a] = std::clamp<Index>(at[a] + kMargin, high[a], grid.size[a] - 1);
    }
  };
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        if (mask[static_cast<std::size_t>(grid.offset(i, j, k))] != 0) widen({i, j, k});
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 at = grid.index(mesh.points.row(v));
    std::array<Index, 3> nearest{};
    for (int a = 0; a < 3; ++a)
      nearest[static_cast<std::size_t>(a)] = static_cast<Index>(std::lround(
          std::clamp(at[a], 0.0, static_cast<double>(grid.size[static_cast<std::size_t>(a)] - 1))));
    widen(nearest);
  }
  Window window;
  window.grid = {{high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1},
                 grid.spacing,
                 grid.position(Vec3(low[0], low[1], low[2])),
                 grid.direction,
                 {}};
  for (Index k = low[2]; k <= high[2]; ++k)
    for (Index j = low[1]; j <= high[1]; ++j)
      for (Index i = low[0]; i <= high[0]; ++i)
        window.mask.push_back(mask[static_cast<std::size_t>(grid.offset(i, j, k))]);
  return window;
}

Volume blurred(const std::vector<std::uint8_t>& mask, const Volume& grid) {
  Volume volume = grid;
  volume.values.assign(mask.begin(), mask.end());
  return smoothed(volume, kBlur * grid.spacing.minCoeff());
}

double dice(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double both = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += a[i] & b[i];
    sum += a[i] + b[i];
  }
  return sum > 0.0 ? 2.0 * both / sum : 1.0;
}

VecX evened(const VecX& values, const Adjacency& neighbours) {
  VecX result(values.size());
  for (Index v = 0; v < static_cast<Index>(values.size()); ++v) {
    double sum = values[v], n = 1.0;
    for (const Index w : neighbours[v]) sum += values[w], n += 1.0;
    result[v] = sum / n;
  }
  return result;
}

}  // namespace

double update_to_mask(TriMesh& mesh, const std::vector<std::uint8_t>& mask, const Volume& grid) {
  require(static_cast<std::int64_t>(mask.size()) == grid.n_voxels(), "a mask of ", mask.size(),
          " voxels does not fit a grid of ", grid.n_voxels());
  require(std::find(mask.begin(), mask.end(), 1) != mask.end(), "an empty mask has no surface");
  const Window part = window_about(mesh, mask, grid);
  const Volume& view = part.grid;
  const Volume wanted = blurred(part.mask, view);
  const Adjacency neighbours = vertex_neighbours(mesh);
  const double step = kStep * grid.spacing.maxCoeff();
  TriMesh best = mesh;
  double reached = -1.0;
  int since = 0;
  for (int round = 0; round <= kRounds; ++round) {
    const auto own = inside_samples(mesh, view.size, [&](const Vec3& p) { return view.index(p); });
    const double overlap = dice(own, part.mask);
    ++since;
    if (overlap > reached) best = mesh, reached = overlap, since = 0;
    if (overlap >= kGoodDice || since > kPatience || round == kRounds) break;
    const Volume present = blurred(own, view);
    VecX move(mesh.n_vertices());
    parallel_for(mesh.n_vertices(), [&](Index v) {
      const Vec3 p = mesh.points.row(v);
      move[v] = !in_view(view, p) ? 0.0 : 2.0 * step * (sample(wanted, p) - sample(present, p));
    });
    for (int pass = 0; pass < kEvening; ++pass) move = evened(move, neighbours);
    mesh.points += move.asDiagonal() * vertex_normals(mesh);
    update_unfolded(mesh);
  }
  mesh = best;
  return reached;
}

}  // namespace coxa::segment
