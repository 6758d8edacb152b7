#include <coxa/medial/trim.h>

#include <coxa/core/error.h>
#include <coxa/medial/face_pair.h>
#include <coxa/mesh/topology.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <cmath>

namespace coxa::medial {
namespace {

constexpr Index kRings = 24, kSpokes = 72;

/// Disc of radius 10 mm with a flat underside; `height(r)` mm above it, 0 at the rim.
template <class Height>
TriMesh disc(const Height& height) {
  const Index inner = (kRings - 1) * kSpokes + 1;  // nodes of a face without its rim
  TriMesh mesh;
  mesh.points.resize(2 * inner + kSpokes, 3);
  std::vector<std::array<Index, 3>> cells;
  for (int face = 0; face < 2; ++face) {
    const Index base = face * inner;
    const auto node = [&](Index ring, Index spoke) {
      if (ring == 0) return base;
      if (ring == kRings) return 2 * inner + spoke % kSpokes;
      return base + 1 + (ring - 1) * kSpokes + spoke % kSpokes;
    };
    for (Index ring = 0; ring <= kRings; ++ring) {
      for (Index spoke = 0; spoke < kSpokes; ++spoke) {
        const double r = 10.0 * ring / kRings, a = 2.0 * kPi * spoke / kSpokes;
        const double z = face == 0 || ring == kRings ? 0.0 : height(r);
        mesh.points.row(node(ring, spoke)) << r * std::cos(a), r * std::sin(a), z;
        if (ring == kRings) continue;
        const auto add = [&](Index i, Index j, Index k) {
          cells.push_back(face == 0 ? std::array<Index, 3>{i, k, j}
                                    : std::array<Index, 3>{i, j, k});
        };
        if (ring > 0) add(node(ring, spoke), node(ring + 1, spoke), node(ring, spoke + 1));
        add(node(ring, spoke + 1), node(ring + 1, spoke), node(ring + 1, spoke + 1));
      }
    }
  }
  mesh.triangles.resize(static_cast<Eigen::Index>(cells.size()), 3);
  for (std::size_t c = 0; c < cells.size(); ++c)
    mesh.triangles.row(static_cast<Eigen::Index>(c)) << cells[c][0], cells[c][1], cells[c][2];
  return mesh;
}

// 1.2 mm thick, falling to 0.3 mm at r = 7, then slowly to nothing at r = 10
double tapering(double r) {
  if (r < 6.0) return 1.2;
  return r < 7.0 ? 1.2 - 0.9 * (r - 6.0) : 0.1 * (10.0 - r);
}

TEST(Trim, CutsAThinBorderZoneButForItsSeam) {
  const TriMesh surface = disc(tapering);
  require_closed_manifold(surface, "disc");
  const FacePair faces(surface, split_sides(surface));
  const auto trimmed = trimmed_sheet(faces, {.thickness = 0.3, .width = 0.4, .margin = 0.8});
  ASSERT_TRUE(trimmed.has_value());
  for (Index v = 0; v < trimmed->sheet.n_vertices(); ++v) {
    const double r = trimmed->sheet.points.row(v).head<2>().norm();
    EXPECT_LT(r, 8.0);
    if (trimmed->cut[static_cast<std::size_t>(v)]) {
      EXPECT_NEAR(r, 7.75, 0.2);
    }
  }
  EXPECT_NEAR(trimmed->depth, 2.25, 0.2);
  EXPECT_NEAR(trimmed->area, kPi * (100.0 - 7.75 * 7.75), 12.0);
  EXPECT_EQ(boundary_loops(trimmed->sheet).size(), 1u);
}

TEST(Trim, LeavesWallsAndBluntEdgesAlone) {
  const TriMesh blunt = disc([](double r) { return std::min(1.2, 10.0 - r); });
  EXPECT_FALSE(trimmed_sheet(FacePair(blunt, split_sides(blunt))).has_value());
  const TriMesh shell = test::lunate_shell(25.0, 1.6);
  EXPECT_FALSE(trimmed_sheet(FacePair(shell, split_sides(shell))).has_value());
}

TEST(Trim, RefusesOptionsOutOfRange) {
  const TriMesh shell = test::lunate_shell(25.0, 1.6);
  const FacePair faces(shell, split_sides(shell));
  EXPECT_THROW(trimmed_sheet(faces, {.thickness = 0.0}), Error);
  EXPECT_THROW(trimmed_sheet(faces, {.margin = 0.0}), Error);
}

}  // namespace
}  // namespace coxa::medial
