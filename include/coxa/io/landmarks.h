#pragma once

#include <coxa/core/types.h>

#include <filesystem>
#include <map>
#include <string>

namespace coxa::io {

/// Named points, LPS mm, of a 3D Slicer markups file (`.mrk.json`, LPS or RAS as it says) or of a
/// CSV whose header has the columns name, x, y, z (LPS mm; rows whose column `kind` is not `point`
/// are passed over).
///
/// Points that Slicer marks as not placed are passed over.
/// @throws Error bad_file if missing or broken; bad_input if a name comes twice or no point is
/// there
std::map<std::string, Vec3> read_landmarks(const std::filesystem::path& path);

/// Writes `.mrk.json` (LPS) or `.csv`.
/// @throws Error bad_input for another extension, bad_file if it cannot be written
void write_landmarks(const std::filesystem::path& path,
                     const std::map<std::string, Vec3>& landmarks);

}  // namespace coxa::io
