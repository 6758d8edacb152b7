#pragma once

#include <coxa/mesh/surface_set.h>

#include <map>
#include <string>
#include <vector>

namespace coxa::segment {

/// A point that a person says a structure's surface passes through.
struct Pin {
  std::string name;       ///< for messages, for example "femur-1"
  std::string structure;  ///< whose surface
  Vec3 place;             ///< LPS mm
  double weight = 1.0;    ///< [0, 1], how far of the way to it the surface goes: 1 all of it
};

/// Farthest that a pin may lie from the surface it pulls, and beyond which from the place it pulls
/// nothing moves, mm.
inline constexpr double kPinReach = 15.0, kPinExtent = 30.0;

/// Moves surfaces so that they pass through their pins.
///
/// Each pin pulls the nearest place of its surface; what lies within 25 mm of that place and faces
/// the same way follows smoothly, so both sides of a thin sheet are not moved together. Layers go
/// with the bone they lie on; last they are laid on their bones again and kept `gap` mm out of each
/// other. Vertices farther than kPinExtent from the places pulled stay what they are, bit for bit.
/// @param host_of  layer -> the bone that it lies on
/// @returns per pin, mm that its surface lies from where its weight asks it to be
/// @throws Error bad_input for a pin of a structure that is not in the set, farther than kPinReach
///         from its surface, or of a weight outside [0, 1]
/// Source: compactly supported radial functions, Wendland 1995; docs/segment.md
std::map<std::string, double> update_pinned(SurfaceSet& surfaces, const std::vector<Pin>& pins,
                                            const std::map<std::string, std::string>& host_of,
                                            double gap);

}  // namespace coxa::segment
