#pragma once

#include <coxa/core/rng.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/image/volume.h>
#include <coxa/mesh/simplex_mesh.h>
#include <coxa/shape/atlas.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/shapes.h"

/// A family of eggs with a bump, an atlas of it, and simulated images: a hip whose truth is known.
namespace coxa::segment::toy {

/// Sizes of an egg in standard deviations of its two modes.
struct Egg {
  double wide = 0.0, tall = 0.0;
};

inline Vec3 egg_point(const Vec3& u, const Egg& egg) {
  const Vec3 axes(24.0 * (1.0 + 0.06 * egg.wide), 20.0, 28.0 * (1.0 + 0.06 * egg.tall));
  const Vec3 bump = Vec3(1.0, 0.5, 0.3).normalized();
  const double growth = 1.0 + 0.25 * std::exp(-5.0 * (u - bump).squaredNorm());
  return growth * axes.cwiseProduct(u);
}

inline TriMesh egg_surface(const Egg& egg, int subdivisions) {
  TriMesh mesh = test::icosphere(subdivisions, 1.0);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    mesh.points.row(v) = egg_point(mesh.points.row(v).transpose().normalized(), egg).transpose();
  }
  return mesh;
}

/// Every fine vertex follows the nearest coarse vertex and two of its neighbours, nearer ones more.
inline LevelMap map_by_distance(const SimplexMesh& coarse, const SimplexMesh& fine) {
  LevelMap map{Triangles(fine.n_vertices(), 3), Points(fine.n_vertices(), 3)};
  for (Index v = 0; v < fine.n_vertices(); ++v) {
    Index nearest = 0;
    (coarse.points.rowwise() - fine.points.row(v)).rowwise().squaredNorm().minCoeff(&nearest);
    std::vector<std::pair<double, Index>> around;
    for (int k = 0; k < 3; ++k) {
      const Index n = coarse.neighbours(nearest, k);
      around.emplace_back((coarse.points.row(n) - fine.points.row(v)).norm(), n);
    }
    std::sort(around.begin(), around.end());
    const double d = (coarse.points.row(nearest) - fine.points.row(v)).norm();
    map.parents.row(v) << nearest, around[0].second, around[1].second;
    map.weights.row(v) << 1.0 / (0.1 + d), 1.0 / (0.1 + around[0].first),
        1.0 / (0.1 + around[1].first);
    map.weights.row(v) /= map.weights.row(v).sum();
  }
  return map;
}

/// Brightness at a signed distance: bright marrow, dark rind of 2 mm, middling outside.
inline double t1_value(double d) {
  const auto step = [](double x) { return 0.5 * (1.0 + std::tanh(x / 0.4)); };
  return 180.0 - 140.0 * step(d + 2.0) + 50.0 * step(d);
}
/// The other contrast: dark inside, bright layer of 2 mm outside.
inline double bright_value(double d) {
  const auto step = [](double x) { return 0.5 * (1.0 + std::tanh(x / 0.4)); };
  return 60.0 + 120.0 * step(d) - 100.0 * step(d - 2.0);
}

inline shape::ProfileSet profiles(const std::string& contrast, Index V, double (*value)(double)) {
  shape::ProfileSet set;
  set.contrast = contrast;
  set.step = 0.5;
  set.n_inside = 8;
  VecX row(15);
  for (Index k = 0; k < row.size(); ++k) row[k] = value((k - set.n_inside) * set.step);
  row.array() -= row.mean();
  row.normalize();
  set.mean = row.transpose().replicate(V, 1);
  set.reliability = VecX::Ones(V);
  return set;
}

inline Points points_of(const Egg& egg, int subdivisions) {
  return make_simplex_mesh(egg_surface(egg, subdivisions)).points;
}

inline shape::Landmarks landmarks_of(const Egg& egg) {
  shape::Landmarks marks;
  const Vec3 directions[8] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0},     {0, -1, 0},
                              {0, 0, 1}, {0, 0, -1}, {1, 0.5, 0.3}, {-1, 1, 0.5}};
  for (int k = 0; k < 8; ++k) {
    marks["mark_" + std::to_string(k)] = egg_point(directions[k].normalized(), egg);
  }
  return marks;
}

/// Atlas of the family: three resolutions of 80, 320 and 1280 vertices, two modes.
inline shape::Atlas atlas() {
  shape::StructureModel model;
  model.name = "egg";
  for (int level = 1; level <= 3; ++level) {
    model.hierarchy.levels.push_back(make_simplex_mesh(egg_surface({}, level)));
  }
  for (std::size_t l = 0; l < 2; ++l) {
    model.hierarchy.maps.push_back(
        map_by_distance(model.hierarchy.levels[l], model.hierarchy.levels[l + 1]));
  }
  const SimplexMesh& finest = model.hierarchy.levels.back();
  const Index V = finest.n_vertices();
  MatX change(3 * Eigen::Index{V}, 2);
  const Points mean = finest.points, wide = points_of({1.0, 0.0}, 3) - mean,
               tall = points_of({0.0, 1.0}, 3) - mean;
  change.col(0) = Eigen::Map<const VecX>(wide.data(), wide.size());
  change.col(1) = Eigen::Map<const VecX>(tall.data(), tall.size());
  change.col(1) -= change.col(0) * change.col(0).dot(change.col(1)) / change.col(0).squaredNorm();
  model.shape.deviations = change.colwise().norm().transpose();
  model.shape.modes = change.array().rowwise() / change.colwise().norm().array();
  model.profiles = {profiles("bright", V, bright_value), profiles("t1", V, t1_value)};
  for (Index v = 0; v < V; ++v) {
    const auto at = [&](Index u) -> Vec3 { return finest.points.row(u).transpose(); };
    const auto n = finest.neighbours.row(v);
    model.reference.push_back(simplex_parameters(at(v), at(n[0]), at(n[1]), at(n[2])));
  }
  shape::Atlas atlas;
  atlas.structures = {model};
  atlas.landmarks = landmarks_of({});
  atlas.subjects = {"toy"};
  return atlas;
}

/// How the image of an egg is taken.
struct Scan {
  Vec3 spacing = Vec3::Constant(1.25);
  double half = 42.0;               ///< mm, half the field of view along x and y
  double low = -42.0, high = 42.0;  ///< mm along z
  double noise = 0.0;
  double core = 24.0;  ///< mm; far from the surface, what is nearer to the origin is inside
  double (*value)(double) = t1_value;
  RigidTransform grid = {};  ///< pose of the grid's axes
};

/// Image of a closed surface, by its signed distance.
inline Volume image_of(const TriMesh& surface, const Scan& scan) {
  Volume volume;
  volume.spacing = scan.spacing;
  volume.direction = scan.grid.R;
  volume.origin = scan.grid * Vec3(-scan.half, -scan.half, scan.low);
  const Vec3 extent(2.0 * scan.half, 2.0 * scan.half, scan.high - scan.low);
  for (int a = 0; a < 3; ++a) {
    volume.size[static_cast<std::size_t>(a)] =
        static_cast<Index>(std::floor(extent[a] / scan.spacing[a])) + 1;
  }
  const TriangleTree tree(surface.points, surface.triangles);
  Rng rng(7);
  for (Index k = 0; k < volume.size[2]; ++k)
    for (Index j = 0; j < volume.size[1]; ++j)
      for (Index i = 0; i < volume.size[0]; ++i) {
        const Vec3 p = volume.position(Vec3(i, j, k));
        const auto near = tree.nearest_within(p, 7.0);
        double d = p.norm() < scan.core ? -7.0 : 7.0;
        if (near) d = tree.sign_at(p, *near) * std::sqrt(near->squared_distance);
        volume.values.push_back(static_cast<float>(scan.value(d) + scan.noise * rng.normal()));
      }
  return volume;
}

/// Mean distance of a result's vertices to the true surface, both ways through the vertices.
inline double mean_distance(const TriMesh& result, const TriMesh& truth) {
  const TriangleTree a(truth.points, truth.triangles), b(result.points, result.triangles);
  double there = 0.0, back = 0.0;
  for (Index v = 0; v < result.n_vertices(); ++v)
    there += std::sqrt(a.nearest(result.points.row(v).transpose()).squared_distance);
  for (Index v = 0; v < truth.n_vertices(); ++v)
    back += std::sqrt(b.nearest(truth.points.row(v).transpose()).squared_distance);
  return 0.5 * (there / result.n_vertices() + back / truth.n_vertices());
}

}  // namespace coxa::segment::toy
