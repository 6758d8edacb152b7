#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/clock_face.h>

#include <array>

namespace coxa::measure {

/// Values of one clock sector of the socket.
struct SectorStatistics {
  Index count = 0;     ///< points with a value
  double mean = kNaN;  ///< weighted; NaN without points
  double low = kNaN;   ///< least value
  double high = kNaN;  ///< greatest value
};

/// Statistics of point values by clock sector; sector h is centred on h o'clock, 0 on twelve.
///
/// @param points  n×3, mm, in the frame of `clock`   @param values  n; NaN is left out
/// @param weights n, >= 0, for example vertex areas; empty: all one
/// @throws Error bad_input if the lengths disagree
std::array<SectorStatistics, 12> sector_statistics(const ClockFace& clock, const Points& points,
                                                   const VecX& values, const VecX& weights = {});

}  // namespace coxa::measure
