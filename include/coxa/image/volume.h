#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/rigid_transform.h>

#include <array>
#include <vector>

namespace coxa {

/// Scalar volume on an oblique regular grid, LPS mm; voxel centres at integer index, x fastest.
struct Volume {
  std::array<Index, 3> size{0, 0, 0};
  Vec3 spacing = Vec3::Ones();        ///< mm
  Vec3 origin = Vec3::Zero();         ///< LPS mm, centre of voxel (0,0,0)
  Mat3 direction = Mat3::Identity();  ///< columns: unit axes of the grid in LPS
  std::vector<float> values;          ///< size[0]*size[1]*size[2]

  std::int64_t n_voxels() const { return static_cast<std::int64_t>(size[0]) * size[1] * size[2]; }
  std::int64_t offset(Index i, Index j, Index k) const {
    return i + static_cast<std::int64_t>(size[0]) * (j + static_cast<std::int64_t>(size[1]) * k);
  }
  Vec3 position(const Vec3& index) const {
    return origin + direction * spacing.cwiseProduct(index);
  }
  Vec3 index(const Vec3& position) const {
    return (direction.transpose() * (position - origin)).cwiseQuotient(spacing);
  }
};

/// True where p lies at least `margin` mm inside the grid's box of voxel centres.
bool in_view(const Volume& volume, const Vec3& p, double margin = 0.0);

/// Trilinear value at LPS p; NaN outside the box of voxel centres.
double sample(const Volume& volume, const Vec3& p);
/// Trilinear value, the nearest voxel's outside.
double sample_clamped(const Volume& volume, const Vec3& p);
/// Gradient of the trilinear interpolant by central differences one voxel apart, per mm, LPS;
/// one-sided within half a voxel of the border, NaN outside the box of voxel centres.
Vec3 sample_gradient(const Volume& volume, const Vec3& p);

/// Gaussian smoothing with the same standard deviation in mm along every axis; weights are
/// renormalised at the borders, so that a constant stays a constant.
Volume smoothed(const Volume& volume, double sigma_mm);
/// Trilinear resampling to isotropic voxels with the same axes and first voxel centre; the last
/// voxel centre lies at most one new voxel inside the old one. Smooth first where the new voxels
/// are larger.
Volume resampled_isotropic(const Volume& volume, double spacing_mm);

}  // namespace coxa
