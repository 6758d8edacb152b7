#include <coxa/medial/medial_sheet.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa::medial {

const TriMesh shell = test::lunate_shell(25.0, 1.6);
const SurfaceSides sides = split_sides(shell);

double mean_edge(const MedialSheet& sheet) {
  double sum = 0.0;
  for (Index c = 0; c < sheet.cells.rows(); ++c)
    for (int k = 0; k < 3; ++k)
      sum += (sheet.nodes.row(sheet.cells(c, k)) - sheet.nodes.row(sheet.cells(c, (k + 1) % 3)))
                 .norm();
  return sum / (3.0 * static_cast<double>(sheet.cells.rows()));
}

TEST(MedialSheet, LiesInTheMiddleOfAShell) {
  const MedialSheet sheet = fit_medial_sheet(shell, sides);
  ASSERT_GT(sheet.nodes.rows(), 50);
  for (Index v = 0; v < sheet.nodes.rows(); ++v) {
    EXPECT_NEAR(sheet.nodes.row(v).norm(), 25.8, 0.05);
    EXPECT_NEAR(sheet.radii[v], 0.8, 0.05);
  }
}

TEST(MedialSheet, HasCellsThatFollowTheThickness) {
  const MedialSheet coarse = fit_medial_sheet(shell, sides, {.cell_per_thickness = 1.2});
  EXPECT_NEAR(mean_edge(coarse), 1.2 * 1.6, 0.15 * 1.2 * 1.6);
  const MedialSheet fine = fit_medial_sheet(shell, sides, {.cell_per_thickness = 0.8});
  EXPECT_NEAR(mean_edge(fine), 0.8 * 1.6, 0.15 * 0.8 * 1.6);
}

TEST(MedialSheet, KeepsToTheLimitsOfCellSizeAndNumber) {
  EXPECT_GT(mean_edge(fit_medial_sheet(shell, sides, {.smallest_cell = 3.0})), 2.5);
  EXPECT_LT(mean_edge(fit_medial_sheet(shell, sides, {.largest_cell = 1.5})), 1.6);
  EXPECT_LT(fit_medial_sheet(shell, sides, {.max_cells = 500}).cells.rows(), 650);
}

TEST(MedialSheet, IsTheSameForOneAndEightThreads) {
  const auto run = [&] { return fit_medial_sheet(shell, sides); };
  const MedialSheet one = with_threads(1, run), eight = with_threads(8, run);
  EXPECT_EQ(one.nodes, eight.nodes);
  EXPECT_EQ(one.cells, eight.cells);
}

TEST(MedialSheet, RefusesOptionsOutOfRange) {
  EXPECT_THROW(fit_medial_sheet(shell, sides, {.cell_per_thickness = 0.0}), Error);
  EXPECT_THROW(fit_medial_sheet(shell, sides, {.smallest_cell = -1.0}), Error);
  EXPECT_THROW(fit_medial_sheet(shell, sides, {.gradation = 0.0}), Error);
  EXPECT_THROW(fit_medial_sheet(shell, sides, {.max_cells = 1}), Error);
  EXPECT_THROW(fit_medial_sheet(shell, sides, {.iterations = 0}), Error);
}

}  // namespace coxa::medial
