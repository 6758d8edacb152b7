#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace coxa::io {

/// All bytes of a file.
/// @throws Error bad_file if it is missing, a folder, or cannot be read
std::string read_bytes(const std::filesystem::path& path);

/// Writes a file so that it appears whole or not at all: beside its place first, then renamed.
///
/// Missing parent folders are made. An existing file is replaced only once the new one is complete.
/// @throws Error bad_file if it cannot be written (disk full, no permission); nothing is left
/// behind
void write_bytes(const std::filesystem::path& path, std::string_view bytes);

/// SHA-256 in lower-case hexadecimal. Source: FIPS 180-4.
std::string sha256_of_bytes(std::string_view bytes);
/// Of a file's bytes, or of a folder: of the sorted relative names and hashes of all files in it.
/// @throws Error bad_file if missing or unreadable
std::string sha256_of_path(const std::filesystem::path& path);

/// Extension in lower case with the compression or format prefix kept: ".nii.gz", ".seg.nrrd",
/// ".mrk.json", else as std::filesystem has it.
std::string extension_of(const std::filesystem::path& path);
/// File name without `extension_of`.
std::string stem_of(const std::filesystem::path& path);

}  // namespace coxa::io
