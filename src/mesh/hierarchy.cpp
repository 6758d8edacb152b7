#include <coxa/mesh/hierarchy.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/closest_point.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/remesh.h>
#include <coxa/mesh/vertex_normals.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace coxa {
namespace {

constexpr double kEvenness = 0.1;

struct Follow {
  Index triangle = 0;
  Vec3 weights = Vec3::Zero();
};

// nearest point of the triangulation whose triangle looks the same way as `normal`
Follow follow(const TriangleTree& tree, const Points& triangle_normals, const Vec3& p,
              const Vec3& normal) {
  const NearestPoint nearest = tree.nearest(p);
  Follow found{nearest.triangle, nearest.barycentric};
  if (triangle_normals.row(nearest.triangle).dot(normal) > 0.0) return found;
  // a thin sheet: search wider for its other side
  const double first = std::sqrt(nearest.squared_distance);
  for (double reach = 2.0 * first; reach < 9.0 * first; reach *= 2.0) {
    double best = kInfinity;
    const Vec3 margin = Vec3::Constant(reach);
    for (Index t : tree.overlapping(p - margin, p + margin)) {
      if (triangle_normals.row(t).dot(normal) <= 0.0) continue;
      const auto corner = [&](int k) { return Vec3(tree.points().row(tree.triangles()(t, k))); };
      const TrianglePoint q = closest_point_on_triangle(p, corner(0), corner(1), corner(2));
      if (q.squared_distance < best) {
        best = q.squared_distance;
        found = {t, q.barycentric};
      }
    }
    if (best < kInfinity) break;
  }
  return found;
}

LevelMap make_map(const SimplexMesh& coarse, const SimplexMesh& fine) {
  const TriMesh surface = face_triangulation(coarse);
  const TriangleTree tree(surface.points, surface.triangles);
  const Points coarse_normals = triangle_normals(surface), normals = simplex_normals(fine);
  LevelMap map;
  map.parents.resize(fine.n_vertices(), 3);
  map.weights.resize(fine.n_vertices(), 3);
  parallel_for(fine.n_vertices(), [&](Index v) {
    const Follow found = follow(tree, coarse_normals, fine.points.row(v), normals.row(v));
    map.parents.row(v) = surface.triangles.row(found.triangle);
    map.weights.row(v) = found.weights;
  });
  return map;
}

// simplex vertices around every face, counter-clockwise from outside
std::vector<std::vector<Index>> face_cycles(const SimplexMesh& mesh) {
  std::vector<std::vector<Index>> cycles(static_cast<std::size_t>(mesh.n_faces));
  for (Index start = 0; start < mesh.n_vertices(); ++start)
    for (int corner = 0; corner < 3; ++corner) {
      const Index face = mesh.faces_of(start, corner);
      auto& cycle = cycles[static_cast<std::size_t>(face)];
      if (!cycle.empty()) continue;
      Index v = start;
      do {
        cycle.push_back(v);
        const int k = mesh.faces_of(v, 0) == face ? 0 : mesh.faces_of(v, 1) == face ? 1 : 2;
        v = mesh.neighbours(v, (k + 2) % 3);
      } while (v != start);
    }
  return cycles;
}

}  // namespace

TriMesh face_triangulation(const SimplexMesh& mesh) {
  std::vector<Index> corners;
  for (const auto& cycle : face_cycles(mesh)) {
    // a strip that zigzags between the two ends of the cycle: better shaped than a fan
    std::size_t low = 0, high = cycle.size() - 1;
    for (bool from_low = true; high - low >= 2; from_low = !from_low) {
      corners.insert(corners.end(),
                     {cycle[low], cycle[from_low ? low + 1 : high - 1], cycle[high]});
      from_low ? ++low : --high;
    }
  }
  return {mesh.points,
          Eigen::Map<const Triangles>(corners.data(), static_cast<Index>(corners.size() / 3), 3)};
}

SimplexHierarchy make_hierarchy(const TriMesh& finest, const HierarchyOptions& options) {
  require(options.n_levels >= 1, "hierarchy: n_levels must be at least 1, got ", options.n_levels);
  require(options.ratio > 1.0, "hierarchy: ratio must be above 1, got ", options.ratio);
  require(options.min_triangles >= 8, "hierarchy: min_triangles must be at least 8, got ",
          options.min_triangles);
  SimplexHierarchy hierarchy;
  hierarchy.levels.push_back(make_simplex_mesh(finest));
  TriMesh surface = finest;
  for (int level = 1; level < options.n_levels; ++level) {
    const auto wanted =
        std::max(options.min_triangles, static_cast<Index>(surface.n_triangles() / options.ratio));
    if (wanted >= surface.n_triangles()) break;
    TriMesh coarser = decimate(surface, {.n_triangles = wanted, .evenness = kEvenness});
    if (coarser.n_triangles() == surface.n_triangles()) break;
    surface = std::move(coarser);
    hierarchy.levels.push_back(make_simplex_mesh(surface));
  }
  std::reverse(hierarchy.levels.begin(), hierarchy.levels.end());
  for (std::size_t l = 0; l + 1 < hierarchy.levels.size(); ++l)
    hierarchy.maps.push_back(make_map(hierarchy.levels[l], hierarchy.levels[l + 1]));
  return hierarchy;
}

Points interpolate(const LevelMap& map, const Points& coarse) {
  Points fine(map.parents.rows(), 3);
  for (Index v = 0; v < fine.rows(); ++v)
    fine.row(v) = map.weights.row(v) * coarse(map.parents.row(v), Eigen::all);
  return fine;
}

Points restrict_mean(const LevelMap& map, const Points& fine, Index n_coarse) {
  require(fine.rows() == map.parents.rows(), "restrict_mean: ", fine.rows(), " values for ",
          map.parents.rows(), " fine vertices");
  Points sum = Points::Zero(n_coarse, 3);
  VecX weights = VecX::Zero(n_coarse);
  for (Index v = 0; v < fine.rows(); ++v)
    for (int k = 0; k < 3; ++k) {
      sum.row(map.parents(v, k)) += map.weights(v, k) * fine.row(v);
      weights[map.parents(v, k)] += map.weights(v, k);
    }
  for (Index c = 0; c < n_coarse; ++c)
    if (weights[c] > 0.0) sum.row(c) /= weights[c];
  return sum;
}

}  // namespace coxa
