#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace coxa::io {

/// One file of a time series.
struct CollectionEntry {
  double time = 0.0;           ///< s, or the frame number
  std::string part;            ///< for example "femoral_cartilage"
  std::filesystem::path file;  ///< relative to the collection's folder
};

/// ParaView data collection (`.pvd`): opens all files as one animation, a part each.
///
/// Parts are numbered in the order of their first appearance.
/// @throws Error bad_input if an entry's file is absolute or is not there; bad_file if it cannot be
/// written
void write_collection(const std::filesystem::path& path,
                      const std::vector<CollectionEntry>& entries);

}  // namespace coxa::io
