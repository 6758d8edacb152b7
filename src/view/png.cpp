#include <coxa/view/png.h>

#include "write_whole.h"

#include <coxa/core/error.h>

#include <zlib.h>

#include <algorithm>
#include <cstdlib>

namespace coxa::view {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append_number(Bytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

void append_chunk(Bytes& file, const char* type, const Bytes& data) {
  append_number(file, static_cast<std::uint32_t>(data.size()));
  const std::size_t start = file.size();
  file.insert(file.end(), type, type + 4);
  file.insert(file.end(), data.begin(), data.end());
  append_number(file, static_cast<std::uint32_t>(
                          crc32(0, file.data() + start, static_cast<uInt>(file.size() - start))));
}

int paeth(int left, int up, int corner) {
  const int a = std::abs(up - corner), b = std::abs(left - corner),
            c = std::abs(left + up - 2 * corner);
  return a <= b && a <= c ? left : b <= c ? up : corner;
}

// every row with PNG filter 4 (Paeth): smooth pictures get small
Bytes filtered_rows(const Image& image) {
  const auto row_bytes = static_cast<std::size_t>(image.width) * 3;
  Bytes above(row_bytes, 0), row(row_bytes), filtered;
  filtered.reserve((row_bytes + 1) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Colour c = image.at(x, y);
      const auto i = static_cast<std::size_t>(x) * 3;
      row[i] = c.r;
      row[i + 1] = c.g;
      row[i + 2] = c.b;
    }
    filtered.push_back(4);
    for (std::size_t i = 0; i < row_bytes; ++i) {
      const int left = i < 3 ? 0 : row[i - 3], corner = i < 3 ? 0 : above[i - 3];
      filtered.push_back(static_cast<std::uint8_t>(row[i] - paeth(left, above[i], corner)));
    }
    above.swap(row);
  }
  return filtered;
}

}  // namespace

Bytes encode_png(const Image& image) {
  require(image.width > 0 && image.height > 0, "a PNG needs at least one pixel");
  Bytes header;
  append_number(header, static_cast<std::uint32_t>(image.width));
  append_number(header, static_cast<std::uint32_t>(image.height));
  header.insert(header.end(), {8, 2, 0, 0, 0});  // 8 bits, RGB, no interlace

  const Bytes rows = filtered_rows(image);
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  Bytes packed(size);
  COXA_ASSERT(compress2(packed.data(), &size, rows.data(), static_cast<uLong>(rows.size()), 6) ==
              Z_OK);
  packed.resize(size);

  Bytes file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk(file, "IHDR", header);
  append_chunk(file, "IDAT", packed);
  append_chunk(file, "IEND", {});
  return file;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  const Bytes bytes = encode_png(image);
  write_whole(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string base64(const Bytes& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace coxa::view
