#include <coxa/segment/muscle_labels.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/voxelize.h>
#include <coxa/segment/distance_map.h>
#include <coxa/segment/label_parts.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "muscle_tissue.h"

namespace coxa::segment {
namespace {

/// mm³. Smaller voxels than this cost time and tell nothing more of a muscle.
constexpr double kLeastVoxel = 2.2;
/// Spreads brighter than muscle at which a step is exp(-1/2) times as likely; and the least weight.
constexpr double kLinkSpreads = 2.5;
constexpr float kLeastLink = 1e-3F;
/// Of the largest piece of a label, the share that another must have.
constexpr double kLeastPiece = 0.05;

/// A body's depth at the voxels of a box of the grid.
struct Depths {
  std::array<Index, 3> low{};
  Volume box;
  std::vector<float> depth;
};

struct Box {
  std::array<Index, 3> low{}, size{};
  bool empty() const { return size[0] <= 0 || size[1] <= 0 || size[2] <= 0; }
};

/// Voxels of the grid within a margin of the mesh.
Box box_about(const TriMesh& mesh, const Volume& grid, double margin) {
  Vec3 low = Vec3::Constant(kInfinity), high = -low;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 at = grid.index(mesh.points.row(v).transpose());
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Index>(a);
    const double m = margin / grid.spacing[axis];
    const auto from = static_cast<Index>(std::clamp(std::floor(low[axis] - m), 0.0, 1e6));
    const auto to = static_cast<Index>(
        std::clamp(std::ceil(high[axis] + m), -1.0, static_cast<double>(grid.size[a]) - 1.0));
    box.low[a] = from;
    box.size[a] = to - from + 1;
  }
  return box;
}

Volume part_of_grid(const Volume& grid, const Box& box) {
  return {box.size,
          grid.spacing,
          grid.position(Vec3(box.low[0], box.low[1], box.low[2])),
          grid.direction,
          {}};
}

/// The image's voxels about the bodies, none smaller than need be.
Volume grid_about(const std::vector<TriMesh>& bodies, const Volume& image,
                  const MuscleLabelOptions& options) {
  Box box{image.size, {0, 0, 0}};
  std::array<Index, 3> end{0, 0, 0};
  for (const TriMesh& body : bodies) {
    const Box own = box_about(body, image, options.claim);
    if (own.empty()) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] = std::min(box.low[a], own.low[a]);
      end[a] = std::max(end[a], own.low[a] + own.size[a]);
    }
  }
  for (std::size_t a = 0; a < 3; ++a) box.size[a] = end[a] - box.low[a];
  Volume grid = part_of_grid(image, box);
  if (box.empty()) return grid;
  Vec3 spacing = image.spacing.cwiseMax(options.finest);
  if (spacing.prod() < kLeastVoxel) spacing = spacing.cwiseMax(std::cbrt(kLeastVoxel));
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Index>(a);
    grid.size[a] = 1 + static_cast<Index>(std::floor(
                           (box.size[a] - 1) * image.spacing[axis] / spacing[axis] + 1e-6));
  }
  grid.spacing = spacing;
  return grid;
}

Depths depths_of(const TriMesh& body, const Volume& grid, double margin) {
  const Box box = box_about(body, grid, margin);
  Depths depths{box.low, part_of_grid(grid, box), {}};
  if (box.empty()) {
    depths.box.size = {0, 0, 0};
    return depths;
  }
  const auto inside =
      inside_samples(body, box.size, [&](const Vec3& p) { return depths.box.index(p); });
  depths.depth = depths_in(inside, depths.box);
  return depths;
}

/// Calls body(voxel of the grid, depth) for all voxels of the box.
template <class Body>
void for_depths(const Volume& grid, const Depths& depths, const Body& body) {
  std::size_t n = 0;
  for (Index k = 0; k < depths.box.size[2]; ++k)
    for (Index j = 0; j < depths.box.size[1]; ++j)
      for (Index i = 0; i < depths.box.size[0]; ++i, ++n)
        body(static_cast<std::size_t>(
                 grid.offset(i + depths.low[0], j + depths.low[1], k + depths.low[2])),
             static_cast<double>(depths.depth[n]));
}

/// The image on the grid.
std::vector<float> brightness_on(const Volume& grid, const Volume& image) {
  std::vector<float> values(static_cast<std::size_t>(grid.n_voxels()));
  // half of what the image is finer than the grid is evened
  const double coarser = (grid.spacing - image.spacing).maxCoeff();
  const Volume source = coarser > 0.1 ? smoothed(image, 0.4 * grid.spacing.minCoeff()) : image;
  parallel_for(grid.size[2], [&](Index k) {
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        values[static_cast<std::size_t>(grid.offset(i, j, k))] =
            static_cast<float>(sample_clamped(source, grid.position(Vec3(i, j, k))));
  });
  return values;
}

Mask filled(const Volume& grid, const std::vector<TriMesh>& meshes) {
  Mask any(static_cast<std::size_t>(grid.n_voxels()), 0);
  for (const TriMesh& mesh : meshes) {
    const auto inside =
        inside_samples(mesh, grid.size, [&](const Vec3& p) { return grid.index(p); });
    for (std::size_t i = 0; i < any.size(); ++i) any[i] |= inside[i];
  }
  return any;
}

/// Links between the tissue's voxels; `number` gives those of its voxels that it has.
WalkGraph links(const std::vector<float>& values, const std::vector<Index>& number, Index n,
                const TissueBrightness& muscle, const Volume& grid) {
  WalkGraph graph;
  graph.next.assign(static_cast<std::size_t>(n), {-1, -1, -1});
  graph.weight.assign(static_cast<std::size_t>(n), {0.0F, 0.0F, 0.0F});
  const double nearest = grid.spacing.minCoeff();
  const auto at = [&](Index i, Index j, Index k) {
    return static_cast<std::size_t>(grid.offset(i, j, k));
  };
  for (Index k = 0; k < grid.size[2]; ++k) {
    for (Index j = 0; j < grid.size[1]; ++j) {
      for (Index i = 0; i < grid.size[0]; ++i) {
        const std::size_t here = at(i, j, k);
        if (number[here] < 0) continue;
        const std::array<Index, 3> place{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          if (place[a] + 1 >= grid.size[a]) continue;
          const std::size_t there = at(i + (a == 0), j + (a == 1), k + (a == 2));
          if (number[there] < 0) continue;
          const double bright = std::max<double>(values[here], values[there]) - muscle.level;
          const double t = std::max(0.0, bright) / (kLinkSpreads * muscle.spread);
          const double step = grid.spacing[static_cast<Index>(a)] / nearest;
          const auto v = static_cast<std::size_t>(number[here]);
          graph.next[v][a] = number[there];
          graph.weight[v][a] = (static_cast<float>(std::exp(-0.5 * t * t)) + kLeastLink) /
                               static_cast<float>(step * step);
        }
      }
    }
  }
  return graph;
}

/// What each body has of the tissue about it; where bodies overlap they share.
std::vector<WalkPrior> priors_of(const std::vector<Depths>& depths,
                                 const std::vector<Index>& number, Index n, const Volume& grid,
                                 const MuscleLabelOptions& options) {
  const auto inside = [&](double depth) {
    return 1.0 / (1.0 + std::exp(std::clamp(-depth / options.softness, -30.0, 30.0)));
  };
  VecX sum = VecX::Zero(n);
  for (const Depths& body : depths)
    for_depths(grid, body, [&](std::size_t v, double depth) {
      if (number[v] >= 0) sum[number[v]] += inside(depth);
    });
  std::vector<WalkPrior> priors(depths.size());
  parallel_for(static_cast<Index>(depths.size()), [&](Index b) {
    WalkPrior& prior = priors[static_cast<std::size_t>(b)];
    for_depths(grid, depths[static_cast<std::size_t>(b)], [&](std::size_t v, double depth) {
      if (number[v] < 0) return;
      const double own = inside(depth) / std::max(1.0, sum[number[v]]);
      const double far = options.far_share * std::exp(std::min(0.0, depth) / options.far_length);
      prior.voxels.push_back(number[v]);
      prior.share.push_back(static_cast<float>(own + far));
    });
  });
  return priors;
}

void count_voxels(BodyLabels& labels, const std::vector<Depths>& depths) {
  labels.bodies.resize(depths.size());
  for (std::size_t b = 0; b < depths.size(); ++b) {
    LabelledBody& body = labels.bodies[b];
    for_depths(labels.grid, depths[b], [&](std::size_t v, double depth) {
      const bool labelled = labels.label[v] == static_cast<int>(b);
      body.in_view += depth > 0.0 ? 1 : 0;
      body.labelled += labelled ? 1 : 0;
      body.both += depth > 0.0 && labelled ? 1 : 0;
    });
  }
}

void check(const MuscleLabelOptions& options) {
  require(options.finest > 0.0 && options.softness > 0.0 && options.claim > 0.0 &&
              options.far_length > 0.0 && options.far_share >= 0.0,
          "the lengths of muscle labels must be positive and far_share at least 0");
}

}  // namespace

BodyLabels muscle_labels(const std::vector<TriMesh>& bodies, const std::vector<TriMesh>& firm,
                         const PreparedImage& image, const MuscleLabelOptions& options,
                         const Monitor& monitor) {
  check(options);
  BodyLabels labels{grid_about(bodies, image.volume, options), {}, {}};
  const Volume& grid = labels.grid;
  if (bodies.empty() || grid.n_voxels() <= 0 ||
      *std::min_element(grid.size.begin(), grid.size.end()) < 1)
    return {};
  const auto n_voxels = static_cast<std::size_t>(grid.n_voxels());
  labels.label.assign(n_voxels, -1);
  std::vector<Depths> depths(bodies.size());
  parallel_for(static_cast<Index>(bodies.size()), [&](Index b) {
    const auto body = static_cast<std::size_t>(b);
    depths[body] = depths_of(bodies[body], grid, 1.5 * options.claim);
  });
  std::vector<float> deepest(n_voxels, static_cast<float>(-kInfinity));
  for (const Depths& body : depths)
    for_depths(grid, body, [&](std::size_t v, double depth) {
      deepest[v] = std::max(deepest[v], static_cast<float>(depth));
    });
  monitor.check_cancelled();
  const std::vector<float> values = brightness_on(grid, image.volume);
  const Mask bone = filled(grid, firm);
  const MuscleRange range = muscle_range(values, deepest, bone, options.claim);
  if (range.high <= range.low) return labels;
  const Mask tissue = muscle_tissue(values, deepest, range, bone, grid, options.claim);
  std::vector<Index> number(n_voxels, -1), voxels;
  for (std::size_t v = 0; v < n_voxels; ++v) {
    if (tissue[v] == 0) continue;
    number[v] = static_cast<Index>(voxels.size());
    voxels.push_back(static_cast<Index>(v));
  }
  const auto n = static_cast<Index>(voxels.size());
  monitor.check_cancelled();
  const std::vector<int> likeliest =
      likeliest_labels(links(values, number, n, range.muscle, grid),
                       priors_of(depths, number, n, grid, options), options.walk, monitor);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    labels.label[static_cast<std::size_t>(voxels[i])] = likeliest[i];
  drop_small_parts(labels, static_cast<int>(bodies.size()), kLeastPiece);
  count_voxels(labels, depths);
  return labels;
}

}  // namespace coxa::segment
