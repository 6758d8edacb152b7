#pragma once

#include <coxa/image/volume.h>
#include <coxa/shape/atlas.h>

#include <string>
#include <vector>

namespace coxa::segment {

/// Landmarks by which a hip is placed, at least.
inline constexpr std::size_t kLeastLandmarks = 6;

/// Mirror images in the plane x = 0: every hip is worked on as a right hip.
Volume mirrored(const Volume& volume);
Points mirrored(const Points& points);
shape::Landmarks mirrored(const shape::Landmarks& landmarks);

/// The landmarks of one side by their atlas names; unknown names and the other side's are left out.
/// @throws Error bad_input when all known ones belong to the other side
shape::Landmarks landmarks_of_side(const shape::Landmarks& given, const shape::Atlas& atlas,
                                   Side side);

/// Where landmarks of a right hip put the atlas' bones: every bone by the similarity of the
/// landmarks that belong to it, since a femur turns in its socket, then all by one thin-plate
/// spline through what is left of the misfits.
///
/// A landmark belongs to the bone it is in or nearest to; one deep inside a bone and near another
/// is a joint centre and belongs to both. A bone with fewer than three takes all landmarks.
/// @param bones          models whose mean shapes are to be placed
/// @param landmark_error mm; larger values let the spline pass landmarks by
/// @returns per bone, its finest mean points placed in the image
/// @throws Error bad_input if fewer than six are known to the atlas, if they lie in a plane, if
/// they fit the other
///         side better, or fit the atlas so badly that names or units must be wrong
std::vector<Points> place_by_landmarks(const std::vector<const shape::StructureModel*>& bones,
                                       const shape::Landmarks& landmarks, const shape::Atlas& atlas,
                                       double landmark_error);

}  // namespace coxa::segment
