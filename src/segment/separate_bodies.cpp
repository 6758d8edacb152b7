#include <coxa/segment/separate_bodies.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/segment/part_bodies.h>
#include <coxa/shape/carve.h>

#include <algorithm>
#include <cmath>

#include "interpolated.h"

namespace coxa::segment {
namespace {

/// mm, of the grid: a share of the body's size (the cube root of its volume) within these bounds.
/// Muscles are no thinner than three times it, apart from their rims.
constexpr double kGridShare = 0.04, kFinestGrid = 0.7, kCoarsestGrid = 1.2;
/// Grid steps, of the new triangles; about as fine as the models'.
constexpr double kEdge = 2.2;
/// Grid steps: rims rounded more would lose muscle.
constexpr double kRounding = 0.5;
/// mm, kept between bodies.
constexpr double kGap = 0.1;
/// Share of a body that is left at least, else it stays as it is, and share below which it is
/// doubtful: what lies in better confirmed bodies for the most part is in a wrong place.
constexpr double kLeastKept = 0.1, kDoubtful = 0.7;

/// Those whose boxes meet the body's.
std::vector<const TriMesh*> near(const TriMesh& mesh, const std::vector<const TriMesh*>& others) {
  const Bounds own = bounds(mesh.points);
  std::vector<const TriMesh*> met;
  for (const TriMesh* other : others) {
    const Bounds box = bounds(other->points);
    if (((box.low - own.high).array() < kGap).all() && ((own.low - box.high).array() < kGap).all())
      met.push_back(other);
  }
  return met;
}

/// Every field of the old surface, at the nearest places of the new one.
std::map<std::string, VecX> carried_fields(const Surface& from, const TriMesh& to) {
  const TriangleTree tree(from.mesh.points, from.mesh.triangles);
  const Index n = to.n_vertices();
  std::vector<NearestPoint> places(static_cast<std::size_t>(n));
  parallel_for(n, [&](Index v) {
    places[static_cast<std::size_t>(v)] = tree.nearest(to.points.row(v).transpose());
  });
  std::map<std::string, VecX> fields;
  for (const auto& [name, values] : from.fields) {
    VecX carried(n);
    for (Index v = 0; v < n; ++v)
      carried[v] = interpolated(values, from.mesh.triangles, places[static_cast<std::size_t>(v)]);
    fields[name] = name == "completed" ? VecX((carried.array() > 0.5).cast<double>()) : carried;
  }
  return fields;
}

/// @returns the share that is left; 0 where that is too little and nothing was taken
double carve(const Separable& body, const std::vector<const TriMesh*>& obstacles) {
  Surface& surface = *body.surface;
  const double before = volume(surface.mesh);
  const double grid = std::clamp(kGridShare * std::cbrt(before), kFinestGrid, kCoarsestGrid);
  TriMesh rest;
  try {
    rest = shape::carved(surface.mesh, obstacles,
                         {.gap = kGap,
                          .spacing = grid,
                          .edge = kEdge * grid,
                          .least_kept = kLeastKept,
                          .least_whole = 0.0,
                          .rounding = kRounding,
                          .anew = body.uneven});
  } catch (const Error& error) {
    if (error.code() != ErrorCode::below_quality) throw;
    return 0.0;
  }
  const double kept = volume(rest) / before;
  update_parted({{&rest}}, obstacles);
  surface.fields = carried_fields(body.fields_of ? *body.fields_of : surface, rest);
  surface.mesh = std::move(rest);
  return kept;
}

}  // namespace

std::vector<std::string> update_separated(std::vector<Separable> soft,
                                          const std::vector<const TriMesh*>& firm,
                                          const Monitor& monitor) {
  std::stable_sort(soft.begin(), soft.end(), [](const Separable& a, const Separable& b) {
    return a.confirmed > b.confirmed;
  });
  std::vector<const TriMesh*> before = firm;
  std::vector<std::string> doubtful;
  for (const Separable& body : soft) {
    monitor.check_cancelled();
    const std::vector<const TriMesh*> met = near(body.surface->mesh, before);
    const double kept = met.empty() && !body.uneven ? 1.0 : carve(body, met);
    if (kept < kDoubtful)
      doubtful.push_back(join_text("low confidence: of the ", body.name, " as found only ",
                                   std::lround(100.0 * kept),
                                   " % lie out of what the image confirms better"));
    before.push_back(&body.surface->mesh);
  }
  return doubtful;
}

}  // namespace coxa::segment
