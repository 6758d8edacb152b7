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
/// "columns", "offset"}]}`; offsets count from the end of the header.
class Bundle {
 public:
  /// @param meta  a JSON object as text
  explicit Bundle(std::string meta = "{}") : meta_(std::move(meta)) {}

  void add(std::string_view name, const MatX& values);  ///< as float32, row by row
  void add(std::string_view name, const Points& values);
  void add(std::string_view name, const Triangles& values);  ///< as uint32
  void add(std::string_view name, std::span<const std::uint8_t> values);
  void add(std::string_view name, std::span<const std::uint16_t> values);

  std::string bytes() const;

 private:
  void add_raw(std::string_view name, std::string_view type, std::int64_t rows,
               std::int64_t columns, std::string_view raw);

  std::string meta_, list_, data_;
};

}  // namespace coxa::serve
