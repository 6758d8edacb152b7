#include <coxa/core/error.h>

#include "volume_formats.h"

#include <map>
#include <sstream>

namespace coxa::io {
namespace {

using Fields = std::map<std::string, std::string>;

/// "Name = value" lines up to ElementDataFile, after which the voxels begin; `size` gets the
/// header's bytes.
Fields parse_fields(std::string_view bytes, const std::string& source, std::size_t& size) {
  Fields fields;
  for (size = 0; size < bytes.size();) {
    const std::size_t end = bytes.find('\n', size);
    const std::size_t equals = bytes.find('=', size);
    if (end == std::string_view::npos || equals >= end) break;
    const auto word = [&](std::size_t from, std::size_t to) {
      std::string text(bytes.substr(from, to - from));
      text.erase(0, text.find_first_not_of(" \t\r"));
      text.erase(text.find_last_not_of(" \t\r") + 1);
      return text;
    };
    const std::string key = word(size, equals);
    fields[key] = word(equals + 1, end);
    size = end + 1;
    if (key == "ElementDataFile") return fields;
  }
  fail(ErrorCode::bad_file, source, " is not MetaImage: the header has no ElementDataFile");
}

/// The value under the first of these names that is there.
std::string value_of(const Fields& fields, std::initializer_list<const char*> names,
                     const std::string& otherwise) {
  for (const char* name : names) {
    const auto found = fields.find(name);
    if (found != fields.end()) return found->second;
  }
  return otherwise;
}

std::vector<double> numbers_in(const std::string& text) {
  std::istringstream words(text);
  std::vector<double> values;
  for (double value; words >> value;) values.push_back(value);
  return values;
}

ScalarType type_named(const std::string& name, const std::string& source) {
  static const std::map<std::string, ScalarType> kNames = {
      {"MET_CHAR", ScalarType::i8},       {"MET_UCHAR", ScalarType::u8},
      {"MET_SHORT", ScalarType::i16},     {"MET_USHORT", ScalarType::u16},
      {"MET_INT", ScalarType::i32},       {"MET_UINT", ScalarType::u32},
      {"MET_LONG_LONG", ScalarType::i64}, {"MET_ULONG_LONG", ScalarType::u64},
      {"MET_FLOAT", ScalarType::f32},     {"MET_DOUBLE", ScalarType::f64}};
  const auto found = kNames.find(name);
  require(found != kNames.end(), source, ": MetaImage type '", name, "' is not supported");
  return found->second;
}

void read_placement(const Fields& fields, const std::string& source, StoredImage& image) {
  const auto axes = numbers_in(
      value_of(fields, {"TransformMatrix", "Rotation", "Orientation"}, "1 0 0 0 1 0 0 0 1"));
  const auto origin = numbers_in(value_of(fields, {"Offset", "Position", "Origin"}, "0 0 0"));
  const auto spacing = numbers_in(value_of(fields, {"ElementSpacing"}, "1 1 1"));
  if (axes.size() != 9 || origin.size() != 3 || spacing.size() != 3) {
    fail(ErrorCode::bad_file, source, ": the placement in the MetaImage header is incomplete");
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const auto column = static_cast<Index>(c);
    image.axes.col(column) = spacing[c] * Vec3(axes[3 * c], axes[3 * c + 1], axes[3 * c + 2]);
    image.origin[column] = origin[c];
  }
}

bool is_true(const std::string& value) {
  return value == "True" || value == "true" || value == "1";
}

}  // namespace

Volume parse_meta_image(std::string_view bytes, const std::string& source) {
  std::size_t header_size = 0;
  const Fields fields = parse_fields(bytes, source, header_size);
  require(fields.at("ElementDataFile") == "LOCAL", source,
          ": MetaImage with its voxels in another file is not supported; save it as .mha");
  require(value_of(fields, {"ElementNumberOfChannels"}, "1") == "1", source,
          " has several values per voxel; a scalar image is needed");
  StoredImage image;
  for (const double n : numbers_in(value_of(fields, {"DimSize"}, ""))) {
    image.size.push_back(static_cast<std::int64_t>(n));
  }
  require(image.size.size() == 3, source, " has ", image.size.size(),
          " axes; a 3-D image is needed");
  read_placement(fields, source, image);
  image.type = type_named(value_of(fields, {"ElementType"}, ""), source);
  image.big_endian =
      is_true(value_of(fields, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}, "False"));
  const bool compressed = is_true(value_of(fields, {"CompressedData"}, "False"));
  const std::string_view data = bytes.substr(header_size);
  const std::string content = compressed ? inflated(data, source) : std::string();
  image.voxels = compressed ? std::string_view(content) : data;
  return make_volume(image, source);
}

}  // namespace coxa::io
