#include "host_patch.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/closest_point.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/vertex_normals.h>

#include <cmath>

namespace coxa::segment {
namespace {

// a thin host's far face looks the other way (cosine)
constexpr double kOtherFace = 0.5;

/// The patch of whole host triangles that have a corner within reach of the sheet on its own side.
SubMesh region_about(const TriMesh& host, const Points& normals, const TriMesh& sheet,
                     double reach) {
  const TriangleTree tree(sheet.points, sheet.triangles);
  const Points sheet_normals = triangle_normals(sheet);
  std::vector<char> near(static_cast<std::size_t>(host.n_vertices()), 0);
  parallel_for(host.n_vertices(), [&](Index v) {
    const auto foot = tree.nearest_within(host.points.row(v).transpose(), reach);
    near[static_cast<std::size_t>(v)] =
        foot && sheet_normals.row(foot->triangle).dot(normals.row(v)) < kOtherFace;
  });
  std::vector<Index> kept;
  for (Index t = 0; t < host.n_triangles(); ++t) {
    bool any = false;
    for (int k = 0; k < 3; ++k)
      any = any || near[static_cast<std::size_t>(host.triangles(t, k))] != 0;
    if (any) kept.push_back(t);
  }
  return sub_mesh(host, kept);
}

/// Every triangle in four; normals at the middles are means.
void update_subdivided(TriMesh& mesh, Points& normals) {
  const MeshEdges edges = mesh_edges(mesh);
  const Index n = mesh.n_vertices(), n_edges = static_cast<Index>(edges.vertices.rows());
  mesh.points.conservativeResize(n + n_edges, 3);
  normals.conservativeResize(n + n_edges, 3);
  for (Index e = 0; e < n_edges; ++e) {
    const Index a = edges.vertices(e, 0), b = edges.vertices(e, 1);
    mesh.points.row(n + e) = 0.5 * (mesh.points.row(a) + mesh.points.row(b));
    normals.row(n + e) = (normals.row(a) + normals.row(b)).normalized();
  }
  Triangles fine(4 * mesh.n_triangles(), 3);
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Index a = mesh.triangles(t, 0), b = mesh.triangles(t, 1), c = mesh.triangles(t, 2);
    const Index ab = n + edges.of_triangle(t, 0), bc = n + edges.of_triangle(t, 1),
                ca = n + edges.of_triangle(t, 2);
    fine.row(4 * t) << a, ab, ca;
    fine.row(4 * t + 1) << b, bc, ab;
    fine.row(4 * t + 2) << c, ca, bc;
    fine.row(4 * t + 3) << ab, bc, ca;
  }
  mesh.triangles = fine;
}

VecX rim_distances(const TriMesh& mesh, const Points& normals, const TriMesh& sheet) {
  // a vertex is under the layer when its foot on the sheet is inside and near
  constexpr double kUnder = 2.0;  // mm
  const TriangleTree tree(sheet.points, sheet.triangles);
  const Points sheet_normals = triangle_normals(sheet);
  const auto loops = boundary_loops(sheet);
  std::vector<bool> on_rim(static_cast<std::size_t>(sheet.n_vertices()), false);
  for (const auto& loop : loops) {
    for (const Index v : loop) on_rim[static_cast<std::size_t>(v)] = true;
  }
  VecX distance(mesh.n_vertices());
  parallel_for(mesh.n_vertices(), [&](Index v) {
    const Vec3 p = mesh.points.row(v);
    double least = kInfinity;
    for (const auto& loop : loops) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3 a = sheet.points.row(loop[i]), b = sheet.points.row(loop[(i + 1) % loop.size()]);
        const Vec3 q = a + closest_parameter_on_segment(p, a, b) * (b - a);
        least = std::min(least, (q - p).norm());
      }
    }
    const NearestPoint foot = tree.nearest(p);
    bool inside = foot.squared_distance < kUnder * kUnder &&
                  sheet_normals.row(foot.triangle).dot(normals.row(v)) < 0.0;
    bool at_rim = true;
    for (int k = 0; k < 3; ++k) {
      if (foot.barycentric[k] > 0.0)
        at_rim = at_rim && on_rim[static_cast<std::size_t>(sheet.triangles(foot.triangle, k))];
    }
    inside = inside && !at_rim;
    distance[v] = inside ? least : -least;
  });
  return distance;
}

}  // namespace

HostPatch patch_about(const TriMesh& host, const TriMesh& sheet, double reach) {
  const Points host_normals = vertex_normals(host);
  const SubMesh region = region_about(host, host_normals, sheet, reach);
  HostPatch patch;
  patch.mesh = region.mesh;
  patch.host_vertex = region.vertex_of;
  patch.normals.resize(region.mesh.n_vertices(), 3);
  for (Index v = 0; v < region.mesh.n_vertices(); ++v)
    patch.normals.row(v) = host_normals.row(region.vertex_of[static_cast<std::size_t>(v)]);
  update_subdivided(patch.mesh, patch.normals);
  patch.neighbours = vertex_neighbours(patch.mesh);
  patch.rim_distance = rim_distances(patch.mesh, patch.normals, sheet);
  return patch;
}

VecX smoothed_on(const HostPatch& patch, const VecX& values, VecX weight, int passes) {
  VecX smooth = values;
  for (int pass = 0; pass < passes; ++pass) {
    VecX next(smooth.size()), next_weight(smooth.size());
    parallel_for(static_cast<std::int64_t>(smooth.size()), [&](Index v) {
      double sum = weight[v] * smooth[v], total = weight[v];
      const auto around = patch.neighbours[v];
      for (const Index w : around) {
        sum += weight[w] * smooth[w];
        total += weight[w];
      }
      next[v] = total > 0.0 ? sum / total : smooth[v];
      next_weight[v] = total / static_cast<double>(around.size() + 1);
    });
    smooth = next;
    weight = next_weight;
  }
  return smooth;
}

}  // namespace coxa::segment
