#include <coxa/segment/label_parts.h>

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/iso_surface.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/sample_grid.h>
#include <coxa/mesh/voxelize.h>
#include <coxa/segment/distance_map.h>

#include <algorithm>
#include <cmath>

namespace coxa::segment {
namespace {

/// Samples of the new surface's grid: farther from the surface only the side counts.
constexpr double kBand = 4.0;
/// Of the sampling: a Gaussian over the depths against the voxels' steps.
constexpr double kEvening = 0.6;
/// Voxels about a label that its depths need.
constexpr Index kMargin = 3;

struct Piece {
  int label = -1;
  std::int64_t n_voxels = 0;
};

/// Numbers the pieces from 0; voxels of no label get -1.
std::vector<Piece> find_pieces(const BodyLabels& labels, std::vector<Index>& piece) {
  const auto& size = labels.grid.size;
  const std::array<std::int64_t, 3> stride{1, size[0], std::int64_t{size[0]} * size[1]};
  piece.assign(labels.label.size(), -1);
  std::vector<Piece> pieces;
  std::vector<std::int64_t> open;
  for (std::size_t first = 0; first < labels.label.size(); ++first) {
    if (labels.label[first] < 0 || piece[first] >= 0) continue;
    const auto number = static_cast<Index>(pieces.size());
    pieces.push_back({labels.label[first], 0});
    piece[first] = number;
    open.assign(1, static_cast<std::int64_t>(first));
    while (!open.empty()) {
      const std::int64_t here = open.back();
      open.pop_back();
      ++pieces.back().n_voxels;
      for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t place = here / stride[a] % size[a];
        for (const int way : {-1, 1}) {
          if (place + way < 0 || place + way >= size[a]) continue;
          const auto there = static_cast<std::size_t>(here + way * stride[a]);
          if (piece[there] >= 0 || labels.label[there] != pieces.back().label) continue;
          piece[there] = number;
          open.push_back(static_cast<std::int64_t>(there));
        }
      }
    }
  }
  return pieces;
}

/// Depth in a label, as a volume about it.
Volume label_depths(const BodyLabels& labels, int label) {
  const Volume& grid = labels.grid;
  std::array<Index, 3> low = grid.size, high{-1, -1, -1};
  for (Index k = 0; k < grid.size[2]; ++k) {
    for (Index j = 0; j < grid.size[1]; ++j) {
      for (Index i = 0; i < grid.size[0]; ++i) {
        if (labels.label[static_cast<std::size_t>(grid.offset(i, j, k))] != label) continue;
        const std::array<Index, 3> at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], std::max<Index>(0, at[a] - kMargin));
          high[a] = std::max(high[a], std::min(grid.size[a] - 1, at[a] + kMargin));
        }
      }
    }
  }
  Volume part{{high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1},
              grid.spacing,
              grid.position(Vec3(low[0], low[1], low[2])),
              grid.direction,
              {}};
  if (high[0] < 0) return part;
  Mask mask;
  for (Index k = low[2]; k <= high[2]; ++k)
    for (Index j = low[1]; j <= high[1]; ++j)
      for (Index i = low[0]; i <= high[0]; ++i)
        mask.push_back(labels.label[static_cast<std::size_t>(grid.offset(i, j, k))] == label);
  part.values = depths_in(mask, part);
  const auto limit = static_cast<float>(2.0 * grid.spacing.maxCoeff());
  for (float& value : part.values) value = std::clamp(value, -limit, limit);
  return smoothed(part, kEvening * grid.spacing.minCoeff());
}

/// About what the label and the body outside the view take.
SampleGrid samples_about(const Volume& depths, const TriMesh& body, double spacing) {
  Bounds box = bounds(body.points);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p = depths.position(Vec3((corner & 1) ? depths.size[0] - 1 : 0,
                                        (corner & 2) ? depths.size[1] - 1 : 0,
                                        (corner & 4) ? depths.size[2] - 1 : 0));
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  SampleGrid samples;
  samples.spacing = spacing;
  samples.origin = box.low.array() - 1.33 * spacing;
  for (int k = 0; k < 3; ++k)
    samples.size[static_cast<std::size_t>(k)] =
        static_cast<Index>(std::ceil((box.high[k] - samples.origin[k]) / spacing)) + 2;
  return samples;
}

}  // namespace

void drop_small_parts(BodyLabels& labels, int n_labels, double least_share) {
  std::vector<Index> piece;
  const std::vector<Piece> pieces = find_pieces(labels, piece);
  std::vector<std::int64_t> largest(static_cast<std::size_t>(n_labels), 0);
  for (const Piece& p : pieces) {
    auto& most = largest[static_cast<std::size_t>(p.label)];
    most = std::max(most, p.n_voxels);
  }
  for (std::size_t v = 0; v < labels.label.size(); ++v) {
    if (piece[v] < 0) continue;
    const Piece& own = pieces[static_cast<std::size_t>(piece[v])];
    const auto most = static_cast<double>(largest[static_cast<std::size_t>(own.label)]);
    if (static_cast<double>(own.n_voxels) < least_share * most) labels.label[v] = -1;
  }
}

TriMesh label_surface(const BodyLabels& labels, int label, const TriMesh& body, double spacing) {
  const Volume depths = label_depths(labels, label);
  if (depths.values.empty()) return {};
  const SampleGrid samples = samples_about(depths, body, spacing);
  const auto inside =
      inside_samples(body, samples.size, [&](const Vec3& p) { return samples.index(p); });
  const TriangleTree tree(body.points, body.triangles);
  const double band = kBand * spacing;
  std::vector<float> values(samples.n(), 0.0F);
  samples.for_samples([&](std::size_t n, const Vec3& p) {
    if (in_view(labels.grid, p)) {
      const double there = sample(depths, p);
      values[n] = static_cast<float>(std::isnan(there) ? -band : std::clamp(there, -band, band));
      return;
    }
    const auto near = tree.nearest_within(p, band);
    const double distance = near ? std::sqrt(near->squared_distance) : band;
    values[n] = static_cast<float>(inside[n] != 0 ? distance : -distance);
  });
  if (std::none_of(values.begin(), values.end(), [](float v) { return v > 0.0F; })) return {};
  return iso_surface(samples.size, values, 0.0,
                     [&](const Vec3& index) { return samples.position(index); });
}

}  // namespace coxa::segment
