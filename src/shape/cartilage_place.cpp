#include "cartilage_place.h"

#include <coxa/geom/fits.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/vertex_normals.h>

#include <algorithm>
#include <optional>

#include "elastic_surface.h"

namespace coxa::shape {
namespace {

// a cartilage and its mean bone are at most so far apart when their examples lie on each other, mm
constexpr double kNear = 6.0;
// the bone side is laid on the bone by displacements that are smooth over this length, mm
constexpr double kSeatLength = 4.0;
constexpr double kLastSeatLength = 1.5;
constexpr int kSeatRounds = 4;

/// Mean place of the cartilage over the examples that have both, in the frame of the mean bone.
std::optional<Points> place_shown_by_examples(const Correspondence& cartilage,
                                              const Points& bone_mean, const Correspondence& bone) {
  Points sum = Points::Zero(cartilage.vertices.front().rows(), 3);
  int count = 0;
  for (std::size_t i = 0; i < cartilage.examples.size(); ++i) {
    const auto it = std::find(bone.examples.begin(), bone.examples.end(), cartilage.examples[i]);
    if (it == bone.examples.end()) continue;
    const auto b = static_cast<std::size_t>(it - bone.examples.begin());
    const Similarity to_mean = fit_similarity(bone.vertices[b], bone_mean, bone.observed[b]);
    sum += transformed(to_mean.scale * cartilage.vertices[i], to_mean.X);
    ++count;
  }
  if (count == 0) return std::nullopt;
  return Points(sum / count);
}

/// The sheet of the bone side, its normals along those of the bone.
TriMesh bone_side_like_bone(const Points& points, const Correspondence& cartilage) {
  TriMesh sheet;
  sheet.triangles = cartilage.triangles.topRows(cartilage.n_bone_side);
  sheet.points = points.topRows(sheet.triangles.maxCoeff() + 1);
  sheet.triangles.col(1).swap(sheet.triangles.col(2));
  return sheet;
}

Points similar(const Points& points, const Points& from, const Points& to) {
  const Similarity fit = fit_similarity(from, to);
  return transformed(fit.scale * points, fit.X);
}

}  // namespace

Points placed_on_bone(const Points& cartilage, const Correspondence& correspondence,
                      const TriMesh& bone, const Correspondence& bone_correspondence, double gap) {
  Points placed = cartilage;
  if (const auto shown = place_shown_by_examples(correspondence, bone.points, bone_correspondence))
    placed = similar(placed, placed, *shown);
  // pose and size by nearest points
  TriMesh sheet = bone_side_like_bone(placed, correspondence);
  const Points fitted = register_similarity({sheet, {}}, {bone, {}}, {.largest_distance = kNear});
  placed = similar(placed, sheet.points, fitted);
  // then every place of the bone side onto the bone
  sheet.points = placed.topRows(sheet.points.rows());
  const Points before = sheet.points;
  const TriangleTree tree(bone.points, bone.triangles);
  const Points normals = triangle_normals(bone);
  const ElasticSurface elastic(sheet);
  for (int round = 0; round < kSeatRounds; ++round) {
    Points goal = sheet.points;
    for (Index v = 0; v < goal.rows(); ++v) {
      const NearestPoint near = tree.nearest(goal.row(v));
      goal.row(v) = near.point.transpose() + gap * normals.row(near.triangle);
    }
    const double length = round + 1 < kSeatRounds ? kSeatLength : kLastSeatLength;
    sheet.points = elastic.relaxed(sheet.points, goal, VecX::Ones(goal.rows()), length);
  }
  // the articular side goes with the vertices opposite it
  const Points moves = sheet.points - before;
  const ShellTopology shell =
      make_shell({before, Triangles(correspondence.triangles.topRows(correspondence.n_bone_side))});
  for (Index v = 0; v < shell.n_sheet_vertices; ++v) {
    placed.row(v) += moves.row(v);
    const Index opposite = shell.articular_vertex[static_cast<std::size_t>(v)];
    if (opposite != v) placed.row(opposite) += moves.row(v);
  }
  return placed;
}

}  // namespace coxa::shape
