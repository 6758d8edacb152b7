#include <coxa/mesh/rebuild.h>

#include "fewer_triangles.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/iso_surface.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/sample_grid.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/voxelize.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace coxa {
namespace {

constexpr double kBand = 2.0;  // grid spacings around the surface where distances are computed
// least distance in grid spacings: a sample on an inner wall is inside all the same
constexpr double kLeast = 0.05;
constexpr std::int64_t kMaxSamples = 200'000'000;

SampleGrid grid_around(const Points& points, double h) {
  const Bounds box = bounds(points);
  const Vec3 cells = ((box.high - box.low) / h).array() + 2.0 * (kBand + 2.0);
  require(cells.prod() < static_cast<double>(kMaxSamples), "rebuild: a spacing of ", h,
          " mm gives too many samples");
  SampleGrid grid;
  grid.spacing = h;
  // half a cell off the corner: rows then rarely run along flat faces
  grid.origin = box.low.array() - (kBand + 1.5) * h;
  for (int k = 0; k < 3; ++k)
    grid.size[static_cast<std::size_t>(k)] = static_cast<Index>(std::ceil(cells[k]));
  return grid;
}

// how many of the six axis directions see each sample inside
std::vector<std::uint8_t> votes(const TriMesh& mesh, const SampleGrid& grid) {
  std::vector<std::uint8_t> sum(grid.n(), 0);
  for (int axis = 0; axis < 3; ++axis)
    for (bool reversed : {false, true}) {
      // grid axes turned cyclically so that rows run along `axis`
      const int a = axis, b = (axis + 1) % 3, c = (axis + 2) % 3;
      const auto at = [&](int k) { return grid.size[static_cast<std::size_t>(k)]; };
      const auto index = [&](const Vec3& p) {
        const Vec3 q = grid.index(p);
        return Vec3(reversed ? at(a) - 1 - q[a] : q[a], q[b], q[c]);
      };
      const auto inside = inside_samples(mesh, {at(a), at(b), at(c)}, index);
      parallel_for(at(c), [&](Index z) {
        for (Index y = 0; y < at(b); ++y)
          for (Index x = 0; x < at(a); ++x) {
            std::array<Index, 3> place{};
            place[static_cast<std::size_t>(a)] = reversed ? at(a) - 1 - x : x;
            place[static_cast<std::size_t>(b)] = y;
            place[static_cast<std::size_t>(c)] = z;
            const std::size_t row = static_cast<std::size_t>(y) +
                                    static_cast<std::size_t>(at(b)) * static_cast<std::size_t>(z);
            sum[grid.offset(place[0], place[1], place[2])] +=
                inside[static_cast<std::size_t>(x) + static_cast<std::size_t>(at(a)) * row];
          }
      });
    }
  return sum;
}

// distance from the surface, positive inside, cut off at the band plus reach
std::vector<float> inner_distance(const TriMesh& mesh, const SampleGrid& grid, double reach = 0.0) {
  const std::vector<std::uint8_t> inside = votes(mesh, grid);
  const TriangleTree tree(mesh.points, mesh.triangles);
  const double band = kBand * grid.spacing + reach;
  std::vector<float> values(grid.n());
  grid.for_samples([&](std::size_t place, const Vec3& p) {
    const auto near = tree.nearest_within(p, band);
    const double distance =
        near ? std::max(kLeast * grid.spacing, std::sqrt(near->squared_distance)) : band;
    values[place] = static_cast<float>(inside[place] > 3 ? distance : -distance);
  });
  return values;
}

/// Gaussian of the given standard deviation (samples) along one axis; values beyond the grid as at
/// its border.
std::vector<float> blurred(const std::vector<float>& values, const SampleGrid& grid, int axis,
                           double deviation) {
  const Index reach = static_cast<Index>(std::ceil(3.0 * deviation));
  std::vector<double> weight(static_cast<std::size_t>(2 * reach + 1));
  double sum = 0.0;
  for (Index d = -reach; d <= reach; ++d)
    sum += weight[static_cast<std::size_t>(d + reach)] =
        std::exp(-0.5 * d * d / (deviation * deviation));
  std::vector<float> result(values.size());
  parallel_for(grid.size[2], [&](Index k) {
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        std::array<Index, 3> at{i, j, k};
        const auto a = static_cast<std::size_t>(axis);
        const Index middle = at[a];
        double mean = 0.0;
        for (Index d = -reach; d <= reach; ++d) {
          at[a] = std::clamp<Index>(middle + d, 0, grid.size[a] - 1);
          mean += weight[static_cast<std::size_t>(d + reach)] *
                  static_cast<double>(values[grid.offset(at[0], at[1], at[2])]);
        }
        result[grid.offset(i, j, k)] = static_cast<float>(mean / sum);
      }
  });
  return result;
}

TriMesh without_crumbs(const TriMesh& mesh) {
  const std::vector<Index> piece = triangle_components(mesh);
  const VecX piece_area = piece_areas(mesh, piece);
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    if (piece_area[piece[static_cast<std::size_t>(t)]] >= 0.01 * piece_area.maxCoeff())
      kept.push_back(t);
  return sub_mesh(mesh, kept).mesh;
}

/// Distances from what remains when the surface is moved inwards and outwards again by `radius`
/// (morphological opening).
std::vector<float> opened(const std::vector<float>& values, const SampleGrid& grid, double radius) {
  if (std::none_of(values.begin(), values.end(), [&](float v) { return double{v} > radius; }))
    fail(ErrorCode::bad_mesh, "nothing of the surface is thicker than ", 2.0 * radius, " mm");
  const auto position = [&](const Vec3& index) { return grid.position(index); };
  const TriMesh core = without_crumbs(iso_surface(grid.size, values, radius, position));
  std::vector<float> distance = inner_distance(core, grid, radius);
  for (float& value : distance) value += static_cast<float>(radius);
  return distance;
}

// the triangle in pieces with edges of at most `edge` mm, three corners each
void append_pieces(const std::array<Vec3, 3>& corners, double edge, std::vector<Vec3>& pieces) {
  const auto& [a, b, c] = corners;
  if (std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()}) <= edge) {
    pieces.insert(pieces.end(), corners.begin(), corners.end());
    return;
  }
  const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
  for (const auto& part : {std::array<Vec3, 3>{a, ab, ca}, std::array<Vec3, 3>{ab, b, bc},
                           std::array<Vec3, 3>{ca, bc, c}, std::array<Vec3, 3>{ab, bc, ca}})
    append_pieces(part, edge, pieces);
}

/// Loose pieces of the old surface that lie outside of what the distances enclose.
TriMesh lost_pieces(const TriMesh& mesh, const std::vector<float>& values, const SampleGrid& grid) {
  constexpr double kPiece = 2.0, kLost = 0.5;  // grid spacings
  std::vector<Vec3> pieces;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    append_pieces({mesh.points.row(mesh.triangles(t, 0)), mesh.points.row(mesh.triangles(t, 1)),
                   mesh.points.row(mesh.triangles(t, 2))},
                  kPiece * grid.spacing, pieces);
  const auto n = static_cast<Index>(pieces.size() / 3);
  std::vector<char> lost(pieces.size() / 3, 1);
  if (std::any_of(values.begin(), values.end(), [](float v) { return v > 0.0f; })) {
    const auto position = [&](const Vec3& i) { return Vec3(grid.origin + grid.spacing * i); };
    const TriMesh seen = iso_surface(grid.size, values, 0.0, position);
    const TriangleTree tree(seen.points, seen.triangles);
    parallel_for(n, [&](Index i) {
      const auto first = static_cast<std::size_t>(3 * i);
      const Vec3 middle = (pieces[first] + pieces[first + 1] + pieces[first + 2]) / 3.0;
      lost[static_cast<std::size_t>(i)] = tree.signed_distance(middle) > kLost * grid.spacing;
    });
  }
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (lost[i / 3]) kept.push_back(pieces[i]);
  TriMesh loose;
  loose.points.resize(static_cast<Index>(kept.size()), 3);
  loose.triangles.resize(static_cast<Index>(kept.size() / 3), 3);
  for (Index i = 0; i < loose.points.rows(); ++i) {
    loose.points.row(i) = kept[static_cast<std::size_t>(i)];
    loose.triangles(i / 3, i % 3) = i;
  }
  return loose;
}

/// Joins walls around loose triangles, `half` mm to both sides, with what the distances enclose.
void update_with_walls(const TriMesh& loose, double half, const SampleGrid& grid,
                       std::vector<float>& values) {
  const TriangleTree tree(loose.points, loose.triangles);
  const double band = half + kBand * grid.spacing;
  parallel_for(grid.size[2], [&](Index k) {
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const auto near = tree.nearest_within(grid.origin + grid.spacing * Vec3(i, j, k), band);
        if (!near) continue;
        float& value = values[grid.offset(i, j, k)];
        value = std::max(value, static_cast<float>(half - std::sqrt(near->squared_distance)));
      }
  });
}

// how far the new surface is from the old one at most
double largest_move(const TriMesh& made, const TriangleTree& old_surface, double allowed) {
  double largest = 0.0;
  for (const auto& p : made.points.rowwise()) {
    const double move = std::sqrt(old_surface.nearest(p.transpose()).squared_distance);
    largest = std::max(largest, move);
    if (move > allowed)
      fail(ErrorCode::bad_mesh, "a new surface would lie ", move, " mm from the old one at (", p[0],
           ", ", p[1], ", ", p[2], ") mm, more than ", allowed, " mm");
  }
  return largest;
}

// how far the old surface reaches out of the new one at most
double largest_loss(const TriMesh& mesh, const TriMesh& made, double allowed) {
  const TriangleTree new_surface(made.points, made.triangles);
  double largest = 0.0;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Vec3 middle = mesh.points(mesh.triangles.row(t), Eigen::all).colwise().mean();
    for (int k = 0; k < 3; ++k) {
      const Vec3 corner = mesh.points.row(mesh.triangles(t, k));
      for (const Vec3& p : {corner, Vec3(0.5 * (corner + middle))})
        largest = std::max(largest, new_surface.signed_distance(p));
    }
  }
  if (largest > allowed)
    fail(ErrorCode::below_quality, "a new surface would leave out what reaches ", largest,
         " mm out of it, more than ", allowed, " mm");
  return largest;
}

}  // namespace

Rebuilt rebuild(const TriMesh& mesh, const RebuildOptions& options) {
  require(options.spacing > 0.0, "rebuild: spacing must be positive, got ", options.spacing, " mm");
  require(options.target_edge > 0.0, "rebuild: target_edge must be positive, got ",
          options.target_edge, " mm");
  require(options.opening >= 0.0, "rebuild: opening must not be negative, got ", options.opening,
          " mm");
  require(options.smoothing >= 0.0, "rebuild: smoothing must not be negative, got ",
          options.smoothing, " mm");
  require(options.thickening >= 0.0, "rebuild: thickening must not be negative, got ",
          options.thickening, " mm");
  require(options.max_move >= 0.0, "rebuild: max_move must not be negative, got ", options.max_move,
          " mm");
  require(options.max_loss >= 0.0, "rebuild: max_loss must not be negative, got ", options.max_loss,
          " mm");
  const TriangleTree old_surface(mesh.points, mesh.triangles);  // refuses what cannot be read
  const SampleGrid grid = grid_around(mesh.points, options.spacing);
  std::vector<float> values = inner_distance(mesh, grid, options.opening);
  if (options.opening > 0.0) values = opened(values, grid, options.opening);
  for (int axis = 0; axis < 3 && options.smoothing > 0.0; ++axis)
    values = blurred(values, grid, axis, options.smoothing / options.spacing);
  double thickened_area = 0.0;
  if (options.thickening > 0.0) {
    const TriMesh loose = lost_pieces(mesh, values, grid);
    if (!loose.empty()) update_with_walls(loose, options.thickening, grid, values);
    thickened_area = loose.empty() ? 0.0 : triangle_areas(loose).sum();
  }
  if (std::none_of(values.begin(), values.end(), [](float v) { return v > 0.0f; }))
    fail(ErrorCode::bad_mesh, "the surface encloses nothing that a grid of ", options.spacing,
         " mm could see");
  const auto position = [&](const Vec3& index) { return grid.position(index); };
  const TriMesh raw = without_crumbs(iso_surface(grid.size, values, 0.0, position));

  if (options.max_loss < kInfinity) largest_loss(mesh, raw, options.max_loss);  // in good time
  Rebuilt result;
  result.mesh = fewer_triangles(raw, options.target_edge, options.spacing);
  result.thickened_area = thickened_area;
  result.largest_move = largest_move(result.mesh, old_surface, options.max_move);
  result.largest_loss = largest_loss(mesh, result.mesh, options.max_loss);
  return result;
}

}  // namespace coxa
