#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::meshing {

/// Polyline along which a surface bends sharply, from one corner to another or closed.
struct FeatureCurve {
  std::vector<Vec3> points;     ///< mm; of a closed one the first is not repeated
  Index first = -1, last = -1;  ///< corners at its ends; -1 of a closed one

  bool closed() const { return first < 0; }
  std::size_t n_segments() const { return closed() ? points.size() : points.size() - 1; }
  const Vec3& end_of(std::size_t segment) const { return points[(segment + 1) % points.size()]; }
  double length() const;  ///< mm
};

struct CurvePlace {
  Vec3 point = Vec3::Zero(), direction = Vec3::UnitX();  ///< nearest point, unit tangent there
  double distance = kInfinity;                           ///< mm
};
CurvePlace nearest_on(const FeatureCurve& curve, const Vec3& p);

/// Ridges and grooves of a surface, and the corners where they end, meet or turn sharply.
struct FeatureCurves {
  std::vector<Vec3> corners;
  std::vector<FeatureCurve> curves;

  CurvePlace nearest(const Vec3& p) const;
};

/// Chains of edges that bend by more than 40 degrees.
/// @param surface   closed, manifold, mm
/// @param shortest  mm, >= 0: shorter chains are left out
FeatureCurves feature_curves(const TriMesh& surface, double shortest);

}  // namespace coxa::meshing
