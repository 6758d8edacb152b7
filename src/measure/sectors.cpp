#include <coxa/measure/sectors.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <cmath>

namespace coxa::measure {

std::array<SectorStatistics, 12> sector_statistics(const ClockFace& clock, const Points& points,
                                                   const VecX& values, const VecX& weights) {
  require(values.size() == points.rows(), "sectors need one value a point: ", points.rows(),
          " points, ", values.size(), " values");
  require(weights.size() == 0 || weights.size() == values.size(),
          "sectors need one weight a value: ", values.size(), " values, ", weights.size(),
          " weights");
  std::array<SectorStatistics, 12> sectors;
  std::array<double, 12> weight{}, sum{};
  for (Index i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    const auto h = static_cast<std::size_t>(clock.sector(points.row(i).transpose()));
    const double w = weights.size() == 0 ? 1.0 : weights[i];
    SectorStatistics& sector = sectors[h];
    sector.low = sector.count == 0 ? values[i] : std::min(sector.low, values[i]);
    sector.high = sector.count == 0 ? values[i] : std::max(sector.high, values[i]);
    ++sector.count;
    weight[h] += w;
    sum[h] += w * values[i];
  }
  for (std::size_t h = 0; h < 12; ++h) {
    if (weight[h] > 0.0) sectors[h].mean = sum[h] / weight[h];
  }
  return sectors;
}

}  // namespace coxa::measure
