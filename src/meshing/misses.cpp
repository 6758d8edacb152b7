#include "misses.h"

#include "surface_places.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>

#include <algorithm>
#include <cmath>

namespace coxa::meshing {
namespace {

std::vector<Vec3> places_of(const TriMesh& surface, double edge) {
  constexpr double kAlongRidges = 0.4, kWithin = 0.8;  // of the edges of the boundary
  std::vector<Vec3> places = places_on(surface, kAlongRidges * edge);
  const std::vector<Vec3> within = places_within(surface, kWithin * edge);
  places.insert(places.end(), within.begin(), within.end());
  return places;
}

std::vector<Vec3> middles_of(const TriMesh& boundary) {
  std::vector<Vec3> middles;
  for (Index f = 0; f < boundary.n_triangles(); ++f) {
    const Vec3 a = boundary.points.row(boundary.triangles(f, 0)),
               b = boundary.points.row(boundary.triangles(f, 1)),
               c = boundary.points.row(boundary.triangles(f, 2));
    for (const Vec3& p :
         {Vec3((a + b + c) / 3.0), Vec3(0.5 * (a + b)), Vec3(0.5 * (b + c)), Vec3(0.5 * (c + a))})
      middles.push_back(p);
  }
  return middles;
}

void add_misses(const std::vector<Vec3>& places, const TriMesh& target, std::vector<Miss>& found) {
  const TriangleTree tree(target.points, target.triangles);
  const std::size_t first = found.size();
  found.resize(first + places.size());
  parallel_for(static_cast<std::int64_t>(places.size()), [&](std::int64_t i) {
    const Vec3& p = places[static_cast<std::size_t>(i)];
    found[first + static_cast<std::size_t>(i)] = {p, std::sqrt(tree.nearest(p).squared_distance)};
  });
}

}  // namespace

std::vector<Miss> misses(const TriMesh& boundary, const TriMesh& surface) {
  std::vector<Miss> found;
  add_misses(places_of(surface, mean_edge_length(boundary)), boundary, found);
  add_misses(middles_of(boundary), surface, found);
  return found;
}

double envelope_error(const TriMesh& boundary, const TriMesh& surface) {
  double farthest = 0.0;
  for (const Miss& miss : misses(boundary, surface)) farthest = std::max(farthest, miss.distance);
  return farthest;
}

}  // namespace coxa::meshing
