#pragma once

#include <coxa/core/types.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace coxa::serve {

/// Named arrays with a JSON header in one block of bytes, little-endian: what the browser draws
/// from without parsing.
///
/// `CXB1`, uint32 length of the header, the header (JSON, padded with spaces to 4 bytes), then the
/// arrays, each starting on 4 bytes. The header is `{"meta": …, "arrays": [{"name", "type", "rows",
/// "columns", "offset"}]}`; offsets count from the end of the header. Type `steps16` stands for
/// numbers in 16 bits, `low + step q` with the array's own `low` and `step`, 65535 for NaN.
class Bundle {
 public:
  /// @param meta  a JSON object as text
  explicit Bundle(std::string meta = "{}") : meta_(std::move(meta)) {}
  void set_meta(std::string meta) { meta_ = std::move(meta); }

  void add(std::string_view name, const MatX& values);  ///< as float32, row by row
  void add(std::string_view name, const Points& values);
  void add(std::string_view name, const Triangles& values);  ///< as uint32
  void add(std::string_view name, std::span<const std::uint8_t> values);
  void add(std::string_view name, std::span<const std::uint16_t> values);
  /// In half the bytes, as `steps16`: each off by at most 1/131000 of the range of all.
  void add_in_steps(std::string_view name, const MatX& values);

  std::string bytes() const;

 private:
  void add_raw(std::string_view name, std::string_view type, std::int64_t rows,
               std::int64_t columns, std::string_view raw, std::string_view more = "");

  std::string meta_, list_, data_;
};

}  // namespace coxa::serve
