#pragma once

#include <coxa/geom/rigid_transform.h>
#include <coxa/motion/joint_centre.h>

#include <vector>

namespace coxa::motion {

/// Hip joint centre in pelvis ISB axes from the origin midway between the ASIS, by regression on
/// the pelvis.
///
/// Harrington et al. 2007 (mm): x = -0.24 PD - 9.9, y = -0.30 PW - 10.9, z = 0.33 PW + 7.3 towards
/// the side; PD from mid-ASIS to mid-PSIS, PW between the ASIS. Interval from its error against CT
/// in 67 people (12.3 ± 5.9 mm, Mantovani 2016).
JointCentre harrington_centre(double pelvis_width, double pelvis_depth, Side side);
/// Bell et al. 1989: 14 % medial, 30 % distal and 22 % posterior of the distance between the ASIS,
/// from the ASIS.
JointCentre bell_centre(double pelvis_width, Side side);

/// Symmetrical centre of rotation (Ehrig et al. 2006): the point fixed in both segments.
///
/// Minimises sum |X_LP c_P - X_LF c_F|² over the frames.
/// @param X_LP, X_LF  poses of two segments, same frames, at least 10
/// @returns the centre in P, with the spread between both images of it as rms
/// @throws Error bad_input when the movement has no rotation about two axes
JointCentre score_centre(const std::vector<RigidTransform>& X_LP,
                         const std::vector<RigidTransform>& X_LF);

/// Centre of the spheres, one radius per marker, on which markers move in the pelvis: geometric
/// least squares from the closed form of Gamage and Lasenby 2002, whose bias under noise this
/// removes.
/// @param trajectories  per marker frames×3 in pelvis axes; NaN rows are left out
JointCentre sphere_centre(const std::vector<Points>& trajectories);
/// The closed form alone, biased towards the markers; for comparison.
Vec3 gamage_lasenby_centre(const std::vector<Points>& trajectories);

}  // namespace coxa::motion
