#include "meshing/element_shape.h"

#include <coxa/core/rng.h>
#include <gtest/gtest.h>

#include <cmath>

namespace coxa::meshing {

const Vec3 A(-1, -1, 1), B(1, 1, 1), C(1, -1, -1), D(-1, 1, -1);  // regular, positive

TEST(ElementShape, OfTheRegularTetrahedronIsBest) {
  EXPECT_NEAR(shape_energy(A, B, C, D), 1.0, 1e-12);
  EXPECT_NEAR(aspect_ratio(A, B, C, D), 1.0, 1e-12);
  EXPECT_NEAR(dihedral_range(A, B, C, D).smallest, std::acos(1.0 / 3.0), 1e-12);
  EXPECT_NEAR(dihedral_range(A, B, C, D).largest, std::acos(1.0 / 3.0), 1e-12);
}

TEST(ElementShape, OfTheCornerOfACubeIsKnown) {
  const Vec3 o = Vec3::Zero(), x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  EXPECT_NEAR(aspect_ratio(o, x, y, z), 3.0 * (1.0 / (3.0 + std::sqrt(3.0))) / std::sqrt(0.75),
              1e-12);
  EXPECT_NEAR(dihedral_range(o, x, y, z).largest, kPi / 2, 1e-12);
  EXPECT_NEAR(dihedral_range(o, x, y, z).smallest, std::acos(1.0 / std::sqrt(3.0)), 1e-12);
}

TEST(ElementShape, OfAnInvertedElementIsInfinite) {
  EXPECT_EQ(shape_energy(B, A, C, D), kInfinity);
  EXPECT_EQ(aspect_ratio(B, A, C, D), 0.0);
  EXPECT_LT(shape_energy(B, A, C, D, 0.1), kInfinity);
}

void expect_derivatives_match(double softening, bool with_hessian) {
  Rng rng(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 a = A + 0.3 * rng.normal3(), b = B + 0.3 * rng.normal3(), c = C, d = D;
    const ShapeDerivatives at = shape_derivatives(a, b, c, d, softening);
    if (at.energy > 50.0) continue;
    constexpr double h = 1e-5;
    for (int k = 0; k < 3; ++k) {
      const Vec3 e = h * Vec3::Unit(k);
      const double slope =
          (shape_energy(a + e, b, c, d, softening) - shape_energy(a - e, b, c, d, softening)) /
          (2 * h);
      EXPECT_NEAR(at.gradient[k], slope, 1e-6 * (1.0 + std::abs(slope)));
      if (!with_hessian) continue;
      const Vec3 row = (shape_derivatives(a + e, b, c, d).gradient -
                        shape_derivatives(a - e, b, c, d).gradient) /
                       (2 * h);
      EXPECT_LE((at.hessian.row(k).transpose() - row).norm(), 1e-5 * (1.0 + row.norm()));
    }
  }
}

TEST(ElementShape, HasTheDerivativesOfItsEnergy) { expect_derivatives_match(0.0, true); }
TEST(ElementShape, HasTheGradientOfItsSoftenedEnergy) { expect_derivatives_match(0.5, false); }

}  // namespace coxa::meshing
