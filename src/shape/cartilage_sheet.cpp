#include "cartilage_sheet.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/vertex_normals.h>

#include <optional>

#include "surface_pulls.h"

namespace coxa::shape {
namespace {

constexpr double kThickest = 8.0;  // mm, of any cartilage
// a normal that meets the other side this many times farther off than its nearest point slants out
// over the rim
constexpr double kSlant = 1.6;

/// Passes over the triangles beside each that even out which side it faces: drawn voxels are rough.
constexpr int kEvening = 6;

/// Means over each triangle and the three beside it, again and again.
VecX evened(VecX values, const MeshEdges& edges, Index n_triangles) {
  for (int pass = 0; pass < kEvening; ++pass) {
    VecX sum = values, count = VecX::Ones(n_triangles);
    for (Index e = 0; e < edges.vertices.rows(); ++e) {
      const auto around = edges.triangles[e];
      if (around.size() != 2) continue;
      sum[around[0]] += values[around[1]];
      sum[around[1]] += values[around[0]];
      count[around[0]] += 1.0;
      count[around[1]] += 1.0;
    }
    values = sum.cwiseQuotient(count);
  }
  return values;
}

/// Of those flagged the largest connected piece stays so.
void keep_largest(const TriMesh& shell, std::vector<bool>& flags, bool flag) {
  std::vector<Index> kept;
  for (Index t = 0; t < shell.n_triangles(); ++t)
    if (flags[static_cast<std::size_t>(t)] == flag) kept.push_back(t);
  if (kept.empty()) return;
  const TriMesh part = sub_mesh(shell, kept).mesh;
  const std::vector<Index> piece = triangle_components(part);
  Index largest = 0;
  piece_areas(part, piece).maxCoeff(&largest);
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (piece[i] != largest) flags[static_cast<std::size_t>(kept[i])] = !flag;
}

/// A vertex at which the border would meet itself goes to the bone side with all about it.
void open_pinches(const TriMesh& shell, const MeshEdges& edges, std::vector<bool>& on_bone) {
  for (bool any = true; any;) {
    any = false;
    Eigen::VectorXi crossings = Eigen::VectorXi::Zero(shell.n_vertices());
    for (Index e = 0; e < edges.vertices.rows(); ++e) {
      const auto around = edges.triangles[e];
      if (around.size() != 2 || on_bone[static_cast<std::size_t>(around[0])] ==
                                    on_bone[static_cast<std::size_t>(around[1])])
        continue;
      ++crossings[edges.vertices(e, 0)];
      ++crossings[edges.vertices(e, 1)];
    }
    for (Index t = 0; t < shell.n_triangles(); ++t) {
      if (on_bone[static_cast<std::size_t>(t)]) continue;
      bool pinched = false;
      for (int c = 0; c < 3; ++c) pinched = pinched || crossings[shell.triangles(t, c)] > 2;
      if (!pinched) continue;
      on_bone[static_cast<std::size_t>(t)] = true;
      any = true;
    }
  }
}

CartilageSides sides_of(const TriMesh& shell, const std::vector<bool>& on_bone) {
  std::vector<Index> bone, joint;
  for (Index t = 0; t < shell.n_triangles(); ++t)
    (on_bone[static_cast<std::size_t>(t)] ? bone : joint).push_back(t);
  if (bone.empty() || joint.empty())
    fail(ErrorCode::bad_mesh, "a cartilage needs a bone side and an articular side, got ",
         bone.size(), " and ", joint.size(), " triangles");
  return {sub_mesh(shell, bone).mesh, sub_mesh(shell, joint).mesh};
}

std::vector<bool> border_vertices(const TriMesh& sheet) {
  std::vector<bool> flags(static_cast<std::size_t>(sheet.n_vertices()), false);
  for (const auto& [a, b] : border_edges(sheet)) flags[static_cast<std::size_t>(a)] = true;
  return flags;
}

/// An inner edge between border vertices: its two triangles and the corner each edge starts at.
struct Chord {
  Index triangle[2];
  int corner[2];
};

std::optional<Chord> find_chord(const TriMesh& sheet) {
  const MeshEdges edges = mesh_edges(sheet);
  const std::vector<bool> border = border_vertices(sheet);
  for (Index e = 0; e < edges.vertices.rows(); ++e) {
    const auto around = edges.triangles[e];
    const bool joins = border[static_cast<std::size_t>(edges.vertices(e, 0))] &&
                       border[static_cast<std::size_t>(edges.vertices(e, 1))];
    if (around.size() != 2 || !joins) continue;
    Chord chord{};
    for (int side = 0; side < 2; ++side) {
      chord.triangle[side] = around[static_cast<std::size_t>(side)];
      for (int c = 0; c < 3; ++c) {
        if (edges.of_triangle(chord.triangle[side], c) == e) chord.corner[side] = c;
      }
    }
    return chord;
  }
  return std::nullopt;
}

/// Splits the edge from `corner` of each triangle at the new vertex `middle`.
void update_split(TriMesh& sheet, const Chord& chord) {
  const Index t0 = chord.triangle[0];
  const Index a = sheet.triangles(t0, chord.corner[0]),
              b = sheet.triangles(t0, (chord.corner[0] + 1) % 3);
  const Index middle = sheet.n_vertices(), n = sheet.n_triangles();
  sheet.points.conservativeResize(middle + 1, 3);
  sheet.points.row(middle) = 0.5 * (sheet.points.row(a) + sheet.points.row(b));
  sheet.triangles.conservativeResize(n + 2, 3);
  for (int side = 0; side < 2; ++side) {
    const Index t = chord.triangle[side];
    const int c = chord.corner[side];
    sheet.triangles.row(n + side) = sheet.triangles.row(t);
    sheet.triangles(t, (c + 1) % 3) = middle;
    sheet.triangles(n + side, c) = middle;
  }
}

}  // namespace

CartilageSides split_cartilage(const TriMesh& shell, Index n_bone_side) {
  std::vector<bool> on_bone(static_cast<std::size_t>(shell.n_triangles()));
  for (Index t = 0; t < shell.n_triangles(); ++t)
    on_bone[static_cast<std::size_t>(t)] = t < n_bone_side;
  return sides_of(shell, on_bone);
}

CartilageSides split_cartilage(const TriMesh& shell, const TriMesh& bone) {
  const TriangleTree tree(bone.points, bone.triangles);
  const Points normals = triangle_normals(shell);
  VecX facing(shell.n_triangles());
  for (Index t = 0; t < shell.n_triangles(); ++t) {
    const Vec3 centroid =
        (shell.points.row(shell.triangles(t, 0)) + shell.points.row(shell.triangles(t, 1)) +
         shell.points.row(shell.triangles(t, 2))) /
        3.0;
    const Vec3 to_bone = tree.nearest(centroid).point - centroid;
    facing[t] = to_bone.normalized().dot(normals.row(t));
  }
  const MeshEdges edges = mesh_edges(shell);
  facing = evened(std::move(facing), edges, shell.n_triangles());
  std::vector<bool> on_bone(static_cast<std::size_t>(shell.n_triangles()));
  for (Index t = 0; t < shell.n_triangles(); ++t)
    on_bone[static_cast<std::size_t>(t)] = facing[t] > 0.0;
  keep_largest(shell, on_bone, true);
  keep_largest(shell, on_bone, false);
  open_pinches(shell, edges, on_bone);
  return sides_of(shell, on_bone);
}

TriMesh without_border_chords(TriMesh sheet) {
  while (const auto chord = find_chord(sheet)) update_split(sheet, *chord);
  return sheet;
}

ShellTopology make_shell(const TriMesh& sheet) {
  const std::vector<bool> border = border_vertices(sheet);
  ShellTopology shell;
  shell.n_sheet_vertices = shell.n_vertices = sheet.n_vertices();
  for (Index v = 0; v < sheet.n_vertices(); ++v)
    shell.articular_vertex.push_back(border[static_cast<std::size_t>(v)] ? v : shell.n_vertices++);
  const Index n = sheet.n_triangles();
  shell.triangles.resize(2 * n, 3);
  shell.triangles.topRows(n) = sheet.triangles;
  for (Index t = 0; t < n; ++t) {
    for (int c = 0; c < 3; ++c) {
      const auto v = static_cast<std::size_t>(sheet.triangles(t, (3 - c) % 3));
      shell.triangles(n + t, c) = shell.articular_vertex[v];
    }
  }
  return shell;
}

Points ShellTopology::points(const Points& sheet, const Points& articular) const {
  Points all(n_vertices, 3);
  all.topRows(n_sheet_vertices) = sheet;
  for (Index v = 0; v < n_sheet_vertices; ++v) {
    const Index opposite = articular_vertex[static_cast<std::size_t>(v)];
    if (opposite != v) all.row(opposite) = articular.row(v);
  }
  return all;
}

Points opposite_points(const TriMesh& sheet, const TriMesh& articular) {
  const TriangleTree tree(articular.points, articular.triangles);
  const Points normals = vertex_normals(sheet);
  Points opposite(sheet.n_vertices(), 3);
  parallel_for(sheet.n_vertices(), [&](Index v) {
    const Vec3 p = sheet.points.row(v), away = -normals.row(v);
    const NearestPoint nearest = tree.nearest(p);
    const auto hit = tree.first_hit(p, away, kThickest);
    const bool straight = hit && hit->distance < kSlant * std::sqrt(nearest.squared_distance);
    opposite.row(v) = straight ? Vec3(p + hit->distance * away) : nearest.point;
  });
  return opposite;
}

}  // namespace coxa::shape
