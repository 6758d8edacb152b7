#pragma once

#include <coxa/core/types.h>

namespace coxa::segment {

/// Value at a place on a surface (a NearestPoint or a RayHit) of what is given per vertex.
template <class Place>
double interpolated(const VecX& values, const Triangles& triangles, const Place& at) {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) sum += at.barycentric[k] * values[triangles(at.triangle, k)];
  return sum;
}
template <class Place>
Vec3 interpolated(const Points& values, const Triangles& triangles, const Place& at) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    sum += at.barycentric[k] * values.row(triangles(at.triangle, k)).transpose();
  return sum;
}

}  // namespace coxa::segment
