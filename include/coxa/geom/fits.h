#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/rigid_transform.h>

namespace coxa {

struct Sphere {
  Vec3 centre = Vec3::Zero();  ///< mm
  double radius = 0.0;         ///< mm
  double rms = 0.0;            ///< mm, of |p - centre| - radius over the points used
};

struct SphereFitOptions {
  double outlier_scale = 0.0;  ///< 0: plain least squares; else Tukey cut-off in robust standard
                               ///< deviations (4.7 usual)
};

/// Tukey's biweights of residuals about zero, cut off at `outlier_scale` robust standard deviations
/// (median absolute residual over 0.6745); 0: all one.
VecX tukey_weights(const VecX& residuals, double outlier_scale);

/// Geometric least-squares sphere (Gauss-Newton from the algebraic fit), optionally robust.
///
/// @param points n×3, n >= 4, not coplanar   @param weights n or empty (all one)
/// @throws Error bad_input if fewer than four points or if they are coplanar
Sphere fit_sphere(const Points& points, const VecX& weights = {},
                  const SphereFitOptions& options = {});

struct Plane {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit; sign arbitrary
};
/// Least-squares plane through n >= 3 points.
Plane fit_plane(const Points& points);

struct Line {
  Vec3 point = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();  ///< unit; sign arbitrary
};
/// Least-squares line through n >= 2 points.
Line fit_line(const Points& points);

/// Rigid X minimising sum w |X a_i - b_i|² (Kabsch; never a reflection). Rows correspond; n >= 3.
RigidTransform fit_rigid(const Points& a, const Points& b, const VecX& weights = {});

struct Similarity {
  double scale = 1.0;
  RigidTransform X;  ///< b = X.R (scale a) + X.p
};
/// Similarity minimising sum w |s R a_i + t - b_i|² (Umeyama 1991).
Similarity fit_similarity(const Points& a, const Points& b, const VecX& weights = {});

struct AffineTransform {
  Mat3 A = Mat3::Identity();
  Vec3 t = Vec3::Zero();
  Vec3 operator*(const Vec3& p) const { return A * p + t; }
};
/// Affine map minimising sum w |A a_i + t - b_i|²; n >= 4, not coplanar.
AffineTransform fit_affine(const Points& a, const Points& b, const VecX& weights = {});

/// Rotation vector (axis times angle, rad) to matrix, and back (angle in [0, pi]).
Mat3 rotation_from_vector(const Vec3& w);
Vec3 rotation_vector(const Mat3& R);

}  // namespace coxa
