#include <coxa/core/rng.h>
#include <coxa/segment/joint_gap.h>
#include <gtest/gtest.h>

#include <cmath>
#include <span>

namespace coxa::segment {
namespace {

constexpr double kRoom = 3.0, kBlur = 0.35;

double past(double s, double at) { return 0.5 * std::erfc(-(s - at) / (std::sqrt(2.0) * kBlur)); }

/// Two layers between dark cortices across z, 3 mm in all; the line between them rises along x.
double middle_at(double x) { return 1.3 + 0.02 * x; }

/// @param line of the gap, its brightness above the layers' times mm
PreparedImage joint_image(double line) {
  PreparedImage image;
  Volume& volume = image.volume;
  volume.size = {21, 21, 41};
  volume.spacing = Vec3::Constant(0.7);
  volume.origin = Vec3(-7.0, -7.0, -10.0);
  Rng rng(5);
  for (Index k = 0; k < volume.size[2]; ++k)
    for (Index j = 0; j < volume.size[1]; ++j)
      for (Index i = 0; i < volume.size[0]; ++i) {
        const Vec3 p = volume.position(Vec3(i, j, k));
        const double t = (p.z() - middle_at(p.x())) / kBlur;
        const double bell = std::exp(-0.5 * t * t) / (kBlur * std::sqrt(2.0 * kPi));
        volume.values.push_back(static_cast<float>(
            20.0 + 100.0 * (past(p.z(), 0.0) - past(p.z(), kRoom)) + line * bell + rng.normal()));
      }
  return image;
}

std::vector<GapRay> ways() {
  std::vector<GapRay> rays;
  for (double x = -5.0; x <= 5.0; x += 1.0)
    for (double y = -5.0; y <= 5.0; y += 1.0)
      rays.push_back({static_cast<Index>(rays.size()), Vec3(x, y, 0.0), Vec3::UnitZ(), kRoom});
  return rays;
}

TEST(JointGap, FindsABrightLineThatTheImageDoesNotResolve) {
  const PreparedImage image = joint_image(30.0);
  // trilinear interpolation adds some blur to the image's own
  const double blur[] = {1.15};
  const auto rays = ways();
  const auto fits = gaps_between(rays, std::span(&image, 1), blur);
  ASSERT_EQ(fits.size(), rays.size());
  double error = 0.0, width = 0.0;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    error += std::abs(fits[i].middle - middle_at(rays[i].place.x()));
    width += fits[i].width;
    EXPECT_LT(fits[i].deviation, 0.5);
  }
  EXPECT_LT(error / static_cast<double>(fits.size()), 0.12);
  EXPECT_NEAR(width / static_cast<double>(fits.size()), 0.3, 0.1);
}
TEST(JointGap, SaysNothingOfADarkLine) {
  const PreparedImage image = joint_image(-30.0);
  const double blur[] = {1.15};
  for (const GapFit& fit : gaps_between(ways(), std::span(&image, 1), blur))
    EXPECT_TRUE(std::isinf(fit.deviation));
}

}  // namespace
}  // namespace coxa::segment
