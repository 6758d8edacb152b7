#pragma once

#include <coxa/geom/thin_plate_spline.h>
#include <coxa/image/volume.h>
#include <coxa/shape/atlas.h>

#include <string>
#include <vector>

namespace coxa::segment {

/// Mirror images in the plane x = 0: every hip is worked on as a right hip.
Volume mirrored(const Volume& volume);
Points mirrored(const Points& points);
shape::Landmarks mirrored(const shape::Landmarks& landmarks);

/// The landmarks of one side by their atlas names; unknown names and the other side's are left out.
/// @throws Error bad_input when all known ones belong to the other side
shape::Landmarks landmarks_of_side(const shape::Landmarks& given, const shape::Atlas& atlas,
                                   Side side);

/// Map from the atlas frame to the image by landmarks of a right hip.
///
/// @param landmark_error mm; larger values let the spline pass landmarks by, and bend less
/// @throws Error bad_input if fewer than six are known to the atlas, if they lie in a plane, if
/// they fit the other
///         side better, or fit the atlas so badly that names or units must be wrong
ThinPlateSpline place_by_landmarks(const shape::Landmarks& landmarks, const shape::Atlas& atlas,
                                   double landmark_error);

}  // namespace coxa::segment
