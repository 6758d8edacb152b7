#include <coxa/segment/tissue_warp.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/voxelize.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace coxa::segment {
namespace {

/// The spread counts so many times: noise and partial volume are tissue still.
constexpr double kSpreads = 2.5;
/// mm. A bone's border shows brightnesses of every tissue: nothing is asked for so near to it.
constexpr double kBoneBorder = 1.5;
/// A demons step is at most about half of this times the grid step.
constexpr double kLargestStep = 1.0;

std::size_t at(const Volume& v, Index i, Index j, Index k) {
  return static_cast<std::size_t>(v.offset(i, j, k));
}

/// An axis-parallel grid about the bodies, as far as the image reaches.
Volume grid_around(const std::vector<TriMesh>& bodies, const Volume& image, double step,
                   double margin) {
  Vec3 low = Vec3::Constant(kInfinity), high = -low;
  for (const TriMesh& body : bodies) {
    low = low.cwiseMin(body.points.colwise().minCoeff().transpose());
    high = high.cwiseMax(body.points.colwise().maxCoeff().transpose());
  }
  Vec3 seen_low = Vec3::Constant(kInfinity), seen_high = -seen_low;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p = image.position(Vec3((corner & 1) ? image.size[0] - 1 : 0,
                                       (corner & 2) ? image.size[1] - 1 : 0,
                                       (corner & 4) ? image.size[2] - 1 : 0));
    seen_low = seen_low.cwiseMin(p);
    seen_high = seen_high.cwiseMax(p);
  }
  low = (low.array() - margin).matrix().cwiseMax(seen_low);
  high = (high.array() + margin).matrix().cwiseMin(seen_high);
  Volume grid;
  grid.spacing = Vec3::Constant(step);
  grid.origin = low;
  for (std::size_t a = 0; a < 3; ++a) {
    const double extent = high[static_cast<Index>(a)] - low[static_cast<Index>(a)];
    grid.size[a] = std::max<Index>(0, static_cast<Index>(std::floor(extent / step)) + 1);
  }
  grid.values.assign(static_cast<std::size_t>(std::max<std::int64_t>(0, grid.n_voxels())), 0.0F);
  return grid;
}

/// Calls body(voxel number, its place) for all voxels.
template <class Body>
void for_voxels(const Volume& grid, const Body& body) {
  parallel_for(grid.size[2], [&](Index k) {
    for (Index j = 0; j < grid.size[1]; ++j) {
      for (Index i = 0; i < grid.size[0]; ++i)
        body(at(grid, i, j, k), grid.position(Vec3(i, j, k)));
    }
  });
}

/// Share of each voxel that the meshes fill, from a grid twice as fine.
Volume filled(const Volume& grid, const std::vector<TriMesh>& meshes) {
  Volume fine = grid;
  fine.spacing = 0.5 * grid.spacing;
  fine.origin = grid.origin - 0.25 * grid.spacing;
  for (std::size_t a = 0; a < 3; ++a) fine.size[a] = 2 * grid.size[a];
  std::vector<std::uint8_t> any(static_cast<std::size_t>(fine.n_voxels()), 0);
  for (const TriMesh& mesh : meshes) {
    const auto inside =
        inside_samples(mesh, fine.size, [&](const Vec3& p) { return fine.index(p); });
    for (std::size_t i = 0; i < any.size(); ++i) any[i] |= inside[i];
  }
  Volume share = grid;
  for (Index k = 0; k < fine.size[2]; ++k) {
    for (Index j = 0; j < fine.size[1]; ++j) {
      for (Index i = 0; i < fine.size[0]; ++i)
        share.values[at(grid, i / 2, j / 2, k / 2)] +=
            0.125F * static_cast<float>(any[at(fine, i, j, k)]);
    }
  }
  return share;
}

/// Image brightness inside the bodies, away from their borders.
std::vector<double> inside_values(const Volume& grid, const Volume& bodies, const Volume& image) {
  std::vector<double> values;
  const Volume deep = smoothed(bodies, 4.0);
  for (Index k = 0; k < grid.size[2]; ++k) {
    for (Index j = 0; j < grid.size[1]; ++j) {
      for (Index i = 0; i < grid.size[0]; ++i) {
        if (deep.values[at(grid, i, j, k)] < 0.85F) continue;
        const double value = sample(image, grid.position(Vec3(i, j, k)));
        if (!std::isnan(value)) values.push_back(value);
      }
    }
  }
  return values;
}

/// Gradient by central differences, per mm.
Vec3 gradient(const Volume& v, Index i, Index j, Index k) {
  const std::array<Index, 3> here{i, j, k};
  Vec3 g;
  for (std::size_t a = 0; a < 3; ++a) {
    auto low = here, high = here;
    low[a] = std::max<Index>(0, here[a] - 1);
    high[a] = std::min(v.size[a] - 1, here[a] + 1);
    const double rise =
        v.values[at(v, high[0], high[1], high[2])] - v.values[at(v, low[0], low[1], low[2])];
    const auto axis = static_cast<Index>(a);
    g[axis] = rise / (std::max<Index>(1, high[a] - low[a]) * v.spacing[axis]);
  }
  return g;
}

/// A displacement at every voxel of a grid: x, y, z.
struct Field {
  std::array<Volume, 3> part;

  explicit Field(const Volume& grid) : part{grid, grid, grid} {
    for (Volume& p : part) std::fill(p.values.begin(), p.values.end(), 0.0F);
  }
  Vec3 at_voxel(std::size_t i) const {
    return {part[0].values[i], part[1].values[i], part[2].values[i]};
  }
  Vec3 at_place(const Vec3& p) const {
    return {sample_clamped(part[0], p), sample_clamped(part[1], p), sample_clamped(part[2], p)};
  }
  void smooth(double sigma) {
    for (Volume& p : part) p = smoothed(p, sigma);
  }
};

/// What stands still and what it is compared with, on one grid.
struct Pair {
  Volume bodies;  ///< the bodies' share of each voxel
  Volume tissue;  ///< likeness; NaN outside the view
};

Pair make_pair(const std::vector<TriMesh>& bodies, const std::vector<TriMesh>& obstacles,
               const PreparedImage& image, double step, double margin) {
  const Volume grid = grid_around(bodies, image.volume, step, margin);
  Pair pair{grid, grid};
  if (grid.n_voxels() <= 0) return pair;
  const Volume all = filled(grid, bodies);
  const Volume bone = smoothed(filled(grid, obstacles), kBoneBorder);
  const TissueBrightness brightness = tissue_brightness(inside_values(grid, all, image.volume));
  const Volume blurred = smoothed(image.volume, 0.4 * step);
  for_voxels(grid, [&](std::size_t i, const Vec3& p) {
    const double free = 1.0 - std::min(1.0, 2.0 * static_cast<double>(bone.values[i]));
    pair.bodies.values[i] = static_cast<float>(free * all.values[i]);
    const double value = sample(blurred, p);
    pair.tissue.values[i] =
        static_cast<float>(std::isnan(value) ? kNaN : free * brightness.likeness(value));
  });
  pair.bodies = smoothed(pair.bodies, 0.6 * step);
  return pair;
}

/// One demons step.
void update_field(const Pair& pair, const Volume& still, const TissueWarpOptions& options,
                  Field& field) {
  const double step = still.spacing[0];
  Field update(still);
  parallel_for(still.size[2], [&](Index k) {
    for (Index j = 0; j < still.size[1]; ++j) {
      for (Index i = 0; i < still.size[0]; ++i) {
        const std::size_t v = at(still, i, j, k);
        const Vec3 p = still.position(Vec3(i, j, k)) + field.at_voxel(v);
        const double there = sample(pair.tissue, p);
        if (std::isnan(there)) continue;
        const Vec3 slope = sample_gradient(pair.tissue, p);
        if (!slope.allFinite()) continue;
        const Vec3 g = 0.5 * (gradient(still, i, j, k) + slope);
        const double off = there - still.values[v];
        const double bound = off / (kLargestStep * step);
        const double denominator = g.squaredNorm() + bound * bound;
        if (denominator < 1e-9) continue;
        const Vec3 move = (-off / denominator) * g;
        for (std::size_t a = 0; a < 3; ++a)
          update.part[a].values[v] = static_cast<float>(move[static_cast<Index>(a)]);
      }
    }
  });
  update.smooth(options.update_smoothing * step);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < still.values.size(); ++i)
      field.part[a].values[i] += update.part[a].values[i];
  }
  field.smooth(options.total_smoothing * step);
}

}  // namespace

double TissueBrightness::likeness(double value) const {
  const double t = (value - level) / (kSpreads * spread);
  return std::exp(-0.5 * t * t);
}

TissueBrightness tissue_brightness(std::vector<double> values) {
  TissueBrightness brightness;
  if (values.empty()) return brightness;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  brightness.level = *middle;
  for (double& value : values) value = std::abs(value - brightness.level);
  std::nth_element(values.begin(), middle, values.end());
  constexpr double kDeviationOfMedian = 1.4826;
  brightness.spread =
      std::max({kDeviationOfMedian * *middle, 0.02 * std::abs(brightness.level), 1e-9});
  return brightness;
}

std::vector<Points> moved_to_tissue(const std::vector<TriMesh>& bodies,
                                    const std::vector<TriMesh>& obstacles,
                                    const PreparedImage& image, const std::vector<Points>& points,
                                    const TissueWarpOptions& options, const Monitor& monitor) {
  require(!options.grids.empty() && options.iterations >= 1,
          "a tissue is warped on at least one grid, in at least one iteration");
  std::optional<Field> field;
  for (std::size_t g = 0; g < options.grids.size(); ++g) {
    const Pair pair = make_pair(bodies, obstacles, image, options.grids[g], options.margin);
    if (pair.bodies.n_voxels() <= 0) return points;
    Field finer(pair.bodies);
    if (field) {
      for (std::size_t a = 0; a < 3; ++a) {
        for_voxels(pair.bodies, [&](std::size_t i, const Vec3& p) {
          finer.part[a].values[i] = static_cast<float>(sample_clamped(field->part[a], p));
        });
      }
    }
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
      monitor.check_cancelled();
      update_field(pair, pair.bodies, options, finer);
    }
    monitor.progress("segment",
                     static_cast<double>(g + 1) / static_cast<double>(options.grids.size()));
    field = std::move(finer);
  }
  std::vector<Points> moved = points;
  for (Points& list : moved) {
    parallel_for(list.rows(), [&](Index v) {
      list.row(v) += field->at_place(list.row(v).transpose()).transpose();
    });
  }
  return moved;
}

}  // namespace coxa::segment
