#include <coxa/pipeline/reference_ranges.h>

#include <coxa/core/error.h>
#include <coxa/io/config.h>

#include <algorithm>
#include <cmath>

namespace coxa::pipeline {
namespace {

std::string place_of(double value, const ReferenceRange& range) {
  if (value < range.low) return join_text("below ", range.low, ": ", range.below);
  if (value > range.high) return join_text("above ", range.high, ": ", range.above);
  if (range.low == -kInfinity) return join_text("not above ", range.high);
  if (range.high == kInfinity) return join_text("not below ", range.low);
  return join_text("within ", range.low, " to ", range.high);
}

}  // namespace

std::map<std::string, ReferenceRange> read_reference_ranges(const std::filesystem::path& path) {
  const io::Table root = io::Table::read(path);
  std::map<std::string, ReferenceRange> ranges;
  for (const io::Table& table : root.tables("range")) {
    const auto measure = table.get<std::string>("measure");
    ReferenceRange range;
    range.low = table.value_or("low", range.low);
    range.high = table.value_or("high", range.high);
    range.source = table.get<std::string>("source");
    if (table.has("low")) range.below = table.get<std::string>("below");
    if (table.has("high")) range.above = table.get<std::string>("above");
    table.finish();
    require(range.low < range.high, table.where("low"), " of ", measure,
            " must be below high, got ", range.low, " and ", range.high);
    require(ranges.emplace(measure, range).second, table.where("measure"), ": ", measure,
            " is there twice");
  }
  root.finish();
  return ranges;
}

std::string judged(double value, const ReferenceRange& range, double interval) {
  if (std::isnan(value)) return "";
  const double to_limit = std::min(std::abs(value - range.low), std::abs(value - range.high));
  return place_of(value, range) + (to_limit < interval ? "; uncertain, the limit lies within the "
                                                         "interval"
                                                       : "");
}

}  // namespace coxa::pipeline
