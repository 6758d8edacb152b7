#include <coxa/core/error.h>

#include "volume_formats.h"

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

namespace coxa::io {
namespace {

struct NrrdHeader {
  std::map<std::string, std::string> fields;                    ///< "name: value"
  std::vector<std::pair<std::string, std::string>> key_values;  ///< "name:=value"
  std::size_t size = 0;                                         ///< bytes up to the data
};

std::string trimmed(std::string text) {
  text.erase(0, text.find_first_not_of(" \t\r"));
  text.erase(text.find_last_not_of(" \t\r") + 1);
  return text;
}

NrrdHeader parse_header(std::string_view bytes, const std::string& source) {
  if (!bytes.starts_with("NRRD")) fail(ErrorCode::bad_file, source, " does not begin with 'NRRD'");
  NrrdHeader header;
  while (header.size < bytes.size()) {
    const std::size_t end = std::min(bytes.find('\n', header.size), bytes.size());
    const std::string line = trimmed(std::string(bytes.substr(header.size, end - header.size)));
    header.size = std::min(end + 1, bytes.size());
    if (line.empty()) return header;
    const std::size_t pair = line.find(":="), field = line.find(": ");
    if (pair != std::string::npos && pair < field) {
      header.key_values.emplace_back(trimmed(line.substr(0, pair)), trimmed(line.substr(pair + 2)));
    } else if (field != std::string::npos && line[0] != '#') {
      header.fields[trimmed(line.substr(0, field))] = trimmed(line.substr(field + 2));
    }
  }
  fail(ErrorCode::bad_file, source, ": the NRRD header does not end");
}

std::string needed(const NrrdHeader& header, const char* field, const std::string& source) {
  const auto found = header.fields.find(field);
  if (found == header.fields.end())
    fail(ErrorCode::bad_file, source, ": the NRRD header lacks '", field, "'");
  return found->second;
}

std::string value_or(const NrrdHeader& header, const char* field, const std::string& otherwise) {
  const auto found = header.fields.find(field);
  return found == header.fields.end() ? otherwise : found->second;
}

ScalarType type_named(const std::string& name, const std::string& source) {
  static const std::map<std::string, ScalarType> kNames = {
      {"signed char", ScalarType::i8},     {"int8", ScalarType::i8},
      {"int8_t", ScalarType::i8},          {"uchar", ScalarType::u8},
      {"unsigned char", ScalarType::u8},   {"uint8", ScalarType::u8},
      {"uint8_t", ScalarType::u8},         {"short", ScalarType::i16},
      {"signed short", ScalarType::i16},   {"int16", ScalarType::i16},
      {"int16_t", ScalarType::i16},        {"ushort", ScalarType::u16},
      {"unsigned short", ScalarType::u16}, {"uint16", ScalarType::u16},
      {"uint16_t", ScalarType::u16},       {"int", ScalarType::i32},
      {"signed int", ScalarType::i32},     {"int32", ScalarType::i32},
      {"int32_t", ScalarType::i32},        {"uint", ScalarType::u32},
      {"unsigned int", ScalarType::u32},   {"uint32", ScalarType::u32},
      {"uint32_t", ScalarType::u32},       {"float", ScalarType::f32},
      {"double", ScalarType::f64}};
  const auto found = kNames.find(name);
  require(found != kNames.end(), source, ": NRRD type '", name, "' is not supported");
  return found->second;
}

/// Factors that take the file's space to LPS.
Vec3 to_lps(const std::string& space, const std::string& source) {
  if (space.empty() || space == "left-posterior-superior" || space == "LPS") return Vec3::Ones();
  if (space == "right-anterior-superior" || space == "RAS") return {-1, -1, 1};
  if (space == "left-anterior-superior" || space == "LAS") return {1, -1, 1};
  fail(ErrorCode::bad_input, source, ": NRRD space '", space, "' is not supported");
}

/// The numbers of "(a,b,c) (d,e,f) …" in order.
std::vector<double> numbers_in(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
  std::istringstream words(text);
  std::vector<double> values;
  for (double value; words >> value;) values.push_back(value);
  return values;
}

void read_placement(const NrrdHeader& header, const std::string& source, StoredImage& image) {
  if (!header.fields.contains("space directions")) {
    const std::vector<double> spacing = numbers_in(value_or(header, "spacings", "1 1 1"));
    if (spacing.size() != 3)
      fail(ErrorCode::bad_file, source, ": NRRD 'spacings' needs three numbers");
    image.axes = Vec3(spacing[0], spacing[1], spacing[2]).asDiagonal();
    return;
  }
  const Vec3 factors = to_lps(value_or(header, "space", ""), source);
  const std::vector<double> axes = numbers_in(needed(header, "space directions", source));
  const std::vector<double> origin = numbers_in(value_or(header, "space origin", "(0,0,0)"));
  if (axes.size() != 9 || origin.size() != 3) {
    fail(ErrorCode::bad_file, source, ": NRRD 'space directions' or 'space origin' is incomplete");
  }
  for (Index c = 0; c < 3; ++c) {
    for (Index r = 0; r < 3; ++r)
      image.axes(r, c) = factors[r] * axes[static_cast<std::size_t>(3 * c + r)];
    image.origin[c] = factors[c] * origin[static_cast<std::size_t>(c)];
  }
}

const char* type_name(VoxelType type) {
  if (type == VoxelType::int16) return "short";
  return type == VoxelType::uint8 ? "uint8" : "float";
}

}  // namespace

Volume parse_nrrd(std::string_view bytes, const std::string& source) {
  const NrrdHeader header = parse_header(bytes, source);
  for (const char* field : {"data file", "datafile", "line skip", "byte skip"}) {
    require(!header.fields.contains(field), source, ": NRRD with '", field,
            "' is not supported; save it as one file");
  }
  StoredImage image;
  for (const double n : numbers_in(needed(header, "sizes", source))) {
    image.size.push_back(static_cast<std::int64_t>(n));
  }
  require(image.size.size() == 3, source, " has ", image.size.size(),
          " axes; a scalar 3-D image is needed (segments that overlap are stored in layers: merge "
          "them)");
  read_placement(header, source, image);
  image.type = type_named(needed(header, "type", source), source);
  image.big_endian = value_or(header, "endian", "little") == "big";
  const std::string encoding = needed(header, "encoding", source);
  const std::string_view data = bytes.substr(header.size);
  require(encoding == "raw" || encoding == "gzip" || encoding == "gz", source, ": NRRD encoding '",
          encoding, "' is not supported; known are raw and gzip");
  const std::string content = encoding == "raw" ? std::string() : inflated(data, source);
  image.voxels = encoding == "raw" ? data : std::string_view(content);
  return make_volume(image, source);
}

std::vector<std::pair<std::string, std::string>> nrrd_key_values(std::string_view bytes) {
  return parse_header(bytes, "NRRD file").key_values;
}

std::string format_nrrd(const Volume& volume, VoxelType type,
                        const std::vector<std::pair<std::string, std::string>>& extra,
                        const std::string& target) {
  std::ostringstream header;
  header.precision(17);
  header << "NRRD0004\ntype: " << type_name(type)
         << "\ndimension: 3\nspace: left-posterior-superior\nsizes: " << volume.size[0] << ' '
         << volume.size[1] << ' ' << volume.size[2] << "\nspace directions:";
  for (Index a = 0; a < 3; ++a) {
    const Vec3 axis = volume.direction.col(a) * volume.spacing[a];
    header << " (" << axis[0] << ',' << axis[1] << ',' << axis[2] << ')';
  }
  header << "\nkinds: domain domain domain\nendian: little\nencoding: gzip\nspace origin: ("
         << volume.origin[0] << ',' << volume.origin[1] << ',' << volume.origin[2] << ")\n";
  for (const auto& [key, value] : extra) header << key << ":=" << value << '\n';
  header << '\n';
  return header.str() + gzipped(voxel_bytes(volume, type, target));
}

}  // namespace coxa::io
