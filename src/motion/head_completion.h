#pragma once

#include "sphere_region.h"

namespace coxa::motion {

/// Axes of a head: columns x, y (superior), z (along the neck). Left-handed for left hips.
Mat3 head_axes(const Vec3& neck, Side side);

/// A femur whose head was completed where it is not in view.
struct CompletedHead {
  SurfaceSamples samples;    ///< those given and the added ones
  double added_share = 0.0;  ///< of the head's directions off the neck, 0..1; 0: nothing was added
  double centre_sd = 0.0;    ///< mm, of the completed sphere's centre for want of the unseen part,
                             ///< largest of the three axes
};

/// Adds the most probable surface to the part of a head that is not in view.
///
/// Centre, radius and shape at once by maximum a posteriori from what is in view. The added surface
/// counts nothing where 97 % of the directions off the neck are in view (whole heads) and fully
/// below 85 %.
/// @param seen  fit of the sphere to the part in view
/// Source: docs/motion.md section 2.
CompletedHead complete_head(const SurfaceSamples& samples, const RegionFit& seen,
                            const HeadPrior& prior, const JointCentreOptions& options);

}  // namespace coxa::motion
