#pragma once

#include <coxa/core/types.h>

namespace coxa::meshing {

/// Shape energy of a tetrahedron, 1 for the regular one, growing without bound as it flattens:
/// (sum of squared edges)^(3/2) / (24 sqrt(3) V), the inverse mean ratio to the power 3/2.
/// Infinite where the volume is not positive.
/// @param softening  as for `shape_derivatives`
double shape_energy(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                    double softening = 0.0);

/// Shape energy and its first two derivatives with respect to the first corner.
///
/// @param softening  mm³, >= 0: with s > 0 six times the volume w is replaced by
///                   (w + sqrt(w² + 4 s²)) / 2, so that inverted elements have a finite, large
///                   energy and a way back. The curvature of that replacement is left out (kept
///                   definite).
/// Source: softening by Escobar et al. 2003.
struct ShapeDerivatives {
  double energy = kInfinity;
  Vec3 gradient = Vec3::Zero();
  Mat3 hessian = Mat3::Zero();
};
ShapeDerivatives shape_derivatives(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                                   double softening = 0.0);

/// 3 r_in / r_circ: 1 for the regular tetrahedron, 0 for a flat or inverted one.
double aspect_ratio(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Smallest and largest of the six dihedral angles, rad.
struct DihedralRange {
  double smallest = 0.0, largest = kPi;
};
DihedralRange dihedral_range(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace coxa::meshing
