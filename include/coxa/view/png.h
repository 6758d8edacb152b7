#pragma once

#include <coxa/view/image.h>

#include <filesystem>
#include <string>
#include <vector>

namespace coxa::view {

/// The picture as a PNG file (8 bits RGB). @throws Error bad_input for an empty picture
std::vector<std::uint8_t> encode_png(const Image& image);

/// Writes a PNG; the file appears whole or not at all. @throws Error bad_file if it cannot be
/// written
void write_png(const std::filesystem::path& path, const Image& image);

/// Bytes in base 64 (RFC 4648), as data addresses in HTML need them.
std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace coxa::view
