#include <coxa/mesh/validate.h>

#include "surface_parts.h"

#include <coxa/core/error.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace coxa {
namespace {

// collects the faults of one kind
class Finder {
 public:
  Finder(const TriMesh& mesh, std::vector<Fault>& faults) : mesh_(mesh), faults_(faults) {}
  void at_vertex(FaultKind kind, Index v) { add(kind, v, mesh_.points.row(v)); }
  void at_triangle(FaultKind kind, Index t) {
    add(kind, t, mesh_.points(mesh_.triangles.row(t), Eigen::all).colwise().mean());
  }
  void add(FaultKind kind, Index first, const Vec3& place) {
    const auto known = std::find_if(faults_.begin(), faults_.end(),
                                    [&](const Fault& f) { return f.kind == kind; });
    if (known != faults_.end())
      ++known->count;
    else
      faults_.push_back({kind, 1, first, place});
  }

 private:
  const TriMesh& mesh_;
  std::vector<Fault>& faults_;
};

// faults that make all further questions meaningless
bool find_unreadable(const TriMesh& mesh, Finder& finder) {
  bool found = false;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    if (mesh.triangles.row(t).minCoeff() < 0 ||
        mesh.triangles.row(t).maxCoeff() >= mesh.n_vertices()) {
      finder.add(FaultKind::bad_index, t, Vec3::Zero());
      found = true;
    }
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (!mesh.points.row(v).allFinite()) {
      finder.at_vertex(FaultKind::not_finite, v);
      found = true;
    }
  return found;
}

void find_vertex_faults(const TriMesh& mesh, Finder& finder) {
  std::vector<Index> order(static_cast<std::size_t>(mesh.n_vertices()));
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](Index v) {
    return std::array{mesh.points(v, 0), mesh.points(v, 1), mesh.points(v, 2)};
  };
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return key(a) < key(b); });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (key(order[i]) == key(order[i - 1])) finder.at_vertex(FaultKind::duplicate_point, order[i]);
  const Adjacency around = vertex_triangles(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (around[v].empty()) finder.at_vertex(FaultKind::unused_vertex, v);
}

void find_triangle_faults(const TriMesh& mesh, double sliver_ratio, Finder& finder) {
  const VecX areas = triangle_areas(mesh);
  std::vector<std::array<Index, 4>> keys;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    std::array<Index, 3> v{mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2)};
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, (mesh.points.row(v[k]) - mesh.points.row(v[(k + 1) % 3])).norm());
    if (!(areas[t] > 1e-14 * longest * longest))
      finder.at_triangle(FaultKind::degenerate_triangle, t);
    else if (2.0 * areas[t] < sliver_ratio * longest * longest)
      finder.at_triangle(FaultKind::sliver, t);
    std::sort(v.begin(), v.end());
    keys.push_back({v[0], v[1], v[2], t});
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i)
    if (std::equal(keys[i].begin(), keys[i].begin() + 3, keys[i - 1].begin()))
      finder.at_triangle(FaultKind::duplicate_triangle, keys[i][3]);
}

void find_edge_faults(const TriMesh& mesh, Finder& finder) {
  const MeshEdges edges = mesh_edges(mesh);
  for (Index e = 0; e < edges.vertices.rows(); ++e) {
    const auto around = edges.triangles[e];
    const Index a = edges.vertices(e, 0), b = edges.vertices(e, 1);
    if (a == b) continue;
    const Vec3 middle = 0.5 * (mesh.points.row(a) + mesh.points.row(b));
    if (around.size() == 1) finder.add(FaultKind::open_boundary, around[0], middle);
    if (around.size() > 2) finder.add(FaultKind::non_manifold_edge, around[0], middle);
    if (around.size() == 2 &&
        runs_along(mesh, around[0], a, b) == runs_along(mesh, around[1], a, b))
      finder.add(FaultKind::mixed_orientation, around[0], middle);
  }
  const std::vector<std::vector<std::vector<Index>>> fans = vertex_fans(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (fans[static_cast<std::size_t>(v)].size() > 1)
      finder.at_vertex(FaultKind::non_manifold_vertex, v);
}

}  // namespace

std::string_view name(FaultKind kind) {
  switch (kind) {
    case FaultKind::bad_index:
      return "vertex number out of range";
    case FaultKind::not_finite:
      return "coordinate not finite";
    case FaultKind::duplicate_point:
      return "duplicate point";
    case FaultKind::unused_vertex:
      return "unused vertex";
    case FaultKind::degenerate_triangle:
      return "triangle without area";
    case FaultKind::duplicate_triangle:
      return "duplicate triangle";
    case FaultKind::sliver:
      return "sliver triangle";
    case FaultKind::open_boundary:
      return "open boundary";
    case FaultKind::non_manifold_edge:
      return "edge with more than two triangles";
    case FaultKind::non_manifold_vertex:
      return "sheets touching in one vertex";
    case FaultKind::mixed_orientation:
      return "triangles oriented against each other";
    case FaultKind::inward_orientation:
      return "closed piece turned inside out";
    case FaultKind::self_intersection:
      return "self-intersection";
  }
  return "";
}

std::string describe(const Fault& fault) {
  const Vec3& p = fault.place;
  return join_text(name(fault.kind), " (", fault.count, fault.count == 1 ? " place" : " places",
                   ", first at (", p[0], ", ", p[1], ", ", p[2], ") mm)");
}

bool ValidityReport::valid() const {
  return std::all_of(faults.begin(), faults.end(),
                     [](const Fault& f) { return f.kind == FaultKind::sliver; });
}

bool ValidityReport::has(FaultKind kind) const {
  return std::any_of(faults.begin(), faults.end(),
                     [kind](const Fault& f) { return f.kind == kind; });
}

std::string ValidityReport::text() const {
  std::string all;
  for (const Fault& fault : faults) all += (all.empty() ? "" : "; ") + describe(fault);
  return all.empty() ? "no fault" : all;
}

ValidityReport validate(const TriMesh& mesh, const ValidateOptions& options) {
  require(0.0 <= options.sliver_ratio && options.sliver_ratio < 1.0,
          "validate: sliver_ratio must be in [0, 1), got ", options.sliver_ratio);
  if (mesh.empty()) fail(ErrorCode::bad_mesh, "the surface has no triangle");
  ValidityReport report;
  Finder finder(mesh, report.faults);
  if (find_unreadable(mesh, finder)) return report;
  find_vertex_faults(mesh, finder);
  find_triangle_faults(mesh, options.sliver_ratio, finder);
  find_edge_faults(mesh, finder);
  if (!report.has(FaultKind::open_boundary) && !report.has(FaultKind::non_manifold_edge) &&
      !report.has(FaultKind::mixed_orientation)) {
    const std::vector<Index> piece_of = triangle_components(mesh);
    const std::vector<bool> inward = inward_pieces(mesh, piece_of);
    for (std::size_t i = 0; i < inward.size(); ++i)
      if (inward[i])
        finder.at_triangle(
            FaultKind::inward_orientation,
            static_cast<Index>(std::find(piece_of.begin(), piece_of.end(), i) - piece_of.begin()));
  }
  for (const auto& pair : self_intersections(mesh))
    finder.at_triangle(FaultKind::self_intersection, pair[0]);
  std::sort(report.faults.begin(), report.faults.end(),
            [](const Fault& a, const Fault& b) { return a.kind < b.kind; });
  return report;
}

}  // namespace coxa
