#pragma once

#include <coxa/core/types.h>

#include <filesystem>
#include <map>
#include <string>

namespace coxa::pipeline {

/// What a measure is held against; an open end is infinite.
struct ReferenceRange {
  double low = -kInfinity, high = kInfinity;
  std::string below = {}, above = {};  ///< what a value outside means, in words
  std::string source = {};
};

/// Ranges by measure, its unit in the name, from a TOML file (`data/reference_ranges.toml`).
/// @throws Error bad_input naming line and key where one is missing, unknown, or without source
std::map<std::string, ReferenceRange> read_reference_ranges(const std::filesystem::path& path);

/// "within 25 to 40", "below 25: …" or "above 40: …"; empty for NaN.
///
/// Where a limit lies nearer than the half-width `interval` of what the value is uncertain by, the
/// text says so.
std::string judged(double value, const ReferenceRange& range, double interval = 0.0);

}  // namespace coxa::pipeline
