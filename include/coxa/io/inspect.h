#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace coxa::io {

/// What a file or folder is and whether it can be used.
struct Inspection {
  std::string kind;  ///< "image", "DICOM folder", "surface", "tetrahedra", "markers", "movement",
                     ///< "landmarks", "configuration", "subject folder", "unknown"
  std::vector<std::string> facts;     ///< sizes, spacing, counts, one line each
  std::vector<std::string> warnings;  ///< usable, but look at this
  std::vector<std::string> problems;  ///< why it cannot be used; empty: usable

  bool usable() const { return problems.empty(); }
};

/// Reads the file as what its name says and looks for what the stages would stumble on.
///
/// Errors of reading become problems. Does not judge whether the anatomy is a hip.
/// @throws Error bad_file only if the path does not exist
Inspection inspect(const std::filesystem::path& path);

}  // namespace coxa::io
