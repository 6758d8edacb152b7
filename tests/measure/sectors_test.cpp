#include <coxa/measure/sectors.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include <cmath>

namespace coxa::measure {

const ClockFace clock_face =
    make_clock_face(Vec3(1, 2, 3), Vec3::UnitZ(), Vec3::UnitY(), Vec3::UnitX());

Vec3 at_hour(double hour) {
  const double turn = hour / 12.0 * 2.0 * kPi;
  return clock_face.centre + 7.0 * Vec3(std::sin(turn), std::cos(turn), 0.4);
}

TEST(SectorStatistics, PutEveryPointAtItsHour) {
  Points points(48, 3);
  VecX values(48);
  for (Index i = 0; i < 48; ++i) {
    points.row(i) = at_hour(i / 4.0 - 0.4).transpose();
    values[i] = std::floor(i / 4.0 + 0.1);  // four points an hour, from 0.4 before it to 0.35 after
  }
  const auto sectors = sector_statistics(clock_face, points, values);
  for (std::size_t h = 0; h < 12; ++h) {
    EXPECT_EQ(sectors[h].count, 4);
    EXPECT_NEAR(sectors[h].mean, static_cast<double>(h), 1e-12);
  }
}
TEST(SectorStatistics, WeightsMeansAndLeavesOutNaN) {
  Points points(3, 3);
  for (Index i = 0; i < 3; ++i) points.row(i) = at_hour(3.1).transpose();
  const auto sectors =
      sector_statistics(clock_face, points, Vec3(1.0, 4.0, kNaN), Vec3(3.0, 1.0, 9.0));
  EXPECT_EQ(sectors[3].count, 2);
  EXPECT_NEAR(sectors[3].mean, 1.75, 1e-12);
  EXPECT_EQ(sectors[3].low, 1.0);
  EXPECT_EQ(sectors[3].high, 4.0);
  EXPECT_TRUE(std::isnan(sectors[9].mean));
}
TEST(SectorStatistics, RejectLengthsThatDisagree) {
  EXPECT_THROW(sector_statistics(clock_face, Points::Zero(2, 3), VecX::Zero(3)), Error);
  EXPECT_THROW(sector_statistics(clock_face, Points::Zero(2, 3), VecX::Zero(2), VecX::Zero(1)),
               Error);
}

}  // namespace coxa::measure
