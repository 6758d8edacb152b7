#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/mesh/tet_quality.h>
#include <coxa/mesh/topology.h>
#include <coxa/meshing/mesh_surface.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

namespace coxa::meshing {
namespace {

constexpr int kMaxTets = 1200;

/// Part of a spherical shell, 0.5 to 4 mm thick, of uneven thickness, notched and noisy.
TriMesh random_shell(std::uint64_t seed) {
  Rng rng(seed);
  const double radius = rng.uniform(15.0, 35.0), thickness = rng.uniform(0.5, 4.0);
  const double span = rng.uniform(1.5, 4.5), width = rng.uniform(0.5, 1.2);
  TriMesh mesh = test::lunate_shell(radius, thickness, span, width, 44, 12);
  const double unevenness = rng.uniform(0.0, 0.4), phase = rng.uniform(0.0, 2.0 * kPi);
  const double notch = rng.uniform(0.0, 0.5), place = rng.uniform(-0.4, 0.4) * span;
  const double noise = rng.uniform(0.0, 0.04) * thickness;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 p = mesh.points.row(v);
    const double a = std::atan2(p[1], p[0]);
    double r = p.norm(), b = std::asin(p[2] / r);
    if (r > radius + 0.5 * thickness)
      r += unevenness * thickness * std::sin(3.0 * a + phase) * std::cos(4.0 * b);
    r += noise * rng.uniform(-1.0, 1.0);
    if (b > 0.0) b *= 1.0 - notch * std::exp(-std::pow((a - place) / 0.2, 2));
    mesh.points.row(v) << r * std::cos(b) * std::cos(a), r * std::cos(b) * std::sin(a),
        r * std::sin(b);
  }
  return mesh;
}

/// What is wrong with the mesh of a shell; empty for a valid one.
std::string fault_of(const TriMesh& shell) {
  try {
    const MeshingResult made = mesh_surface(shell, {.max_tets = kMaxTets});
    const TetMesh& mesh = made.mesh;
    if (tet_volumes(mesh.points, mesh.tets).minCoeff() <= 0.0) return "inverted element";
    std::vector<Index> all(static_cast<std::size_t>(mesh.facets.rows()));
    for (std::size_t f = 0; f < all.size(); ++f) all[f] = static_cast<Index>(f);
    const std::string fault = manifold_fault(sub_mesh({mesh.points, mesh.facets}, all).mesh);
    if (!fault.empty()) return fault;
    for (const FacetTag tag : {FacetTag::bone_side, FacetTag::articular_side})
      if (std::count(mesh.facet_tags.begin(), mesh.facet_tags.end(), tag) < 100)
        return "a face without facets";
    return mesh.n_tets() <= kMaxTets ? "" : "too many elements";
  } catch (const Error& error) {
    return error.what();
  }
}

int from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : otherwise;
}

// COXA_RANDOM_SHELLS sets how many are tried, a few thousand for a full run, which goes on from
// COXA_FIRST_SHELL and tells every hundredth seed
TEST(RandomShells, AllGetValidMeshes) {
  const int first = from_environment("COXA_FIRST_SHELL", 1);
  const int last = from_environment("COXA_RANDOM_SHELLS", 12);
  for (int seed = first; seed <= last; ++seed) {
    EXPECT_EQ(fault_of(random_shell(static_cast<std::uint64_t>(seed))), "") << "seed " << seed;
    if (seed % 100 == 0) std::cout << "shells up to seed " << seed << std::endl;
  }
}

}  // namespace
}  // namespace coxa::meshing
