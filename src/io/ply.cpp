#include <coxa/core/error.h>

#include "surface_formats.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>
#include <sstream>
#include <utility>

namespace coxa::io {
namespace {

static_assert(std::endian::native == std::endian::little);

enum class Encoding { ascii, little_endian, big_endian };
enum class Scalar { i8, u8, i16, u16, i32, u32, f32, f64 };

struct Property {
  std::string name;
  Scalar type = Scalar::f32;
  std::optional<Scalar> count_type;  ///< set for a list
};
struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};
struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::vector<std::string> comments;
  std::size_t size = 0;  ///< bytes up to the data
};

std::optional<Scalar> scalar_named(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, Scalar>, 16> kNames = {
      {{"char", Scalar::i8},
       {"int8", Scalar::i8},
       {"uchar", Scalar::u8},
       {"uint8", Scalar::u8},
       {"short", Scalar::i16},
       {"int16", Scalar::i16},
       {"ushort", Scalar::u16},
       {"uint16", Scalar::u16},
       {"int", Scalar::i32},
       {"int32", Scalar::i32},
       {"uint", Scalar::u32},
       {"uint32", Scalar::u32},
       {"float", Scalar::f32},
       {"float32", Scalar::f32},
       {"double", Scalar::f64},
       {"float64", Scalar::f64}}};
  for (const auto& [known, type] : kNames) {
    if (known == name) return type;
  }
  return std::nullopt;
}

Property parse_property(std::istringstream& words, const std::string& line,
                        const std::string& source) {
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    words >> type;
    property.count_type = scalar_named(type);
    if (!property.count_type)
      fail(ErrorCode::bad_file, source, ": header line '", line, "' is not PLY");
    words >> type;
  }
  words >> property.name;
  const std::optional<Scalar> scalar = scalar_named(type);
  if (!scalar || property.name.empty()) {
    fail(ErrorCode::bad_file, source, ": header line '", line, "' is not PLY");
  }
  property.type = *scalar;
  return property;
}

Encoding encoding_named(const std::string& name, const std::string& source) {
  if (name == "ascii") return Encoding::ascii;
  if (name == "binary_little_endian") return Encoding::little_endian;
  if (name == "binary_big_endian") return Encoding::big_endian;
  fail(ErrorCode::bad_file, source, ": PLY format '", name, "' is not known");
}

void update_header(Header& header, const std::string& line, const std::string& source) {
  std::istringstream words(line);
  std::string keyword;
  words >> keyword;
  if (keyword == "comment") {
    header.comments.push_back(line.size() > 8 ? line.substr(8) : "");
  } else if (keyword == "format") {
    std::string encoding;
    words >> encoding;
    header.encoding = encoding_named(encoding, source);
  } else if (keyword == "element") {
    Element element;
    if (!(words >> element.name >> element.count) || element.count < 0) {
      fail(ErrorCode::bad_file, source, ": header line '", line, "' is not PLY");
    }
    header.elements.push_back(element);
  } else if (keyword == "property" && !header.elements.empty()) {
    header.elements.back().properties.push_back(parse_property(words, line, source));
  }
}

Header parse_header(std::string_view bytes, const std::string& source) {
  if (!bytes.starts_with("ply")) fail(ErrorCode::bad_file, source, " does not begin with 'ply'");
  Header header;
  while (header.size < bytes.size()) {
    const std::size_t end = bytes.find('\n', header.size);
    if (end == std::string_view::npos) break;
    std::string line(bytes.substr(header.size, end - header.size));
    header.size = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line == "end_header") return header;
    update_header(header, line, source);
  }
  fail(ErrorCode::bad_file, source, ": the PLY header has no end_header");
}

/// Reads numbers one after the other from the data part, whatever the encoding.
class Cursor {
 public:
  Cursor(std::string_view data, Encoding encoding, const std::string& source)
      : data_(data), encoding_(encoding), source_(source) {}

  double next(Scalar type) {
    if (encoding_ == Encoding::ascii) return next_text();
    switch (type) {
      case Scalar::i8:
        return next_binary<std::int8_t>();
      case Scalar::u8:
        return next_binary<std::uint8_t>();
      case Scalar::i16:
        return next_binary<std::int16_t>();
      case Scalar::u16:
        return next_binary<std::uint16_t>();
      case Scalar::i32:
        return next_binary<std::int32_t>();
      case Scalar::u32:
        return next_binary<std::uint32_t>();
      case Scalar::f32:
        return static_cast<double>(next_binary<float>());
      case Scalar::f64:
        return next_binary<double>();
    }
    return kNaN;
  }

 private:
  [[noreturn]] void ended() const {
    fail(ErrorCode::bad_file, source_, " ends before its data are complete");
  }

  double next_text() {
    while (!data_.empty() && static_cast<unsigned char>(data_.front()) <= ' ')
      data_.remove_prefix(1);
    if (data_.empty()) ended();
    double value = 0.0;
    const auto [end, status] = std::from_chars(data_.data(), data_.data() + data_.size(), value);
    if (status != std::errc()) {
      fail(ErrorCode::bad_file, source_, ": '", data_.substr(0, data_.find_first_of(" \r\n")),
           "' is not a number");
    }
    data_.remove_prefix(static_cast<std::size_t>(end - data_.data()));
    return value;
  }

  template <class T>
  T next_binary() {
    if (data_.size() < sizeof(T)) ended();
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), data_.data(), sizeof(T));
    if (encoding_ == Encoding::big_endian) std::reverse(raw.begin(), raw.end());
    data_.remove_prefix(sizeof(T));
    return std::bit_cast<T>(raw);
  }

  std::string_view data_;
  Encoding encoding_;
  const std::string& source_;
};

bool is_position(const std::string& name) { return name == "x" || name == "y" || name == "z"; }

/// Normals and colours are not fields of a surface.
bool is_field(const Property& property) {
  for (const char* other : {"nx", "ny", "nz", "red", "green", "blue", "alpha"}) {
    if (property.name == other) return false;
  }
  return !property.count_type && !is_position(property.name);
}

void read_vertices(const Element& element, Cursor& cursor, const std::string& source,
                   Surface& surface) {
  int axes = 0;
  for (const Property& property : element.properties) {
    axes += is_position(property.name) && !property.count_type ? 1 : 0;
    if (is_field(property)) surface.fields[property.name].resize(element.count);
  }
  if (axes != 3) fail(ErrorCode::bad_file, source, ": PLY vertices lack x, y or z");
  surface.mesh.points.resize(element.count, 3);
  for (std::int64_t v = 0; v < element.count; ++v) {
    for (const Property& property : element.properties) {
      if (property.count_type) {
        for (double n = cursor.next(*property.count_type); n > 0; --n) cursor.next(property.type);
        continue;
      }
      const double value = cursor.next(property.type);
      if (is_position(property.name)) surface.mesh.points(v, property.name[0] - 'x') = value;
      if (is_field(property)) surface.fields[property.name][v] = value;
    }
  }
}

void read_faces(const Element& element, Cursor& cursor, Surface& surface) {
  TriangleList triangles;
  std::vector<Index> corners;
  for (std::int64_t f = 0; f < element.count; ++f) {
    for (const Property& property : element.properties) {
      double n = property.count_type ? cursor.next(*property.count_type) : 1.0;
      corners.clear();
      for (; n > 0; --n) corners.push_back(static_cast<Index>(cursor.next(property.type)));
      if (property.name.starts_with("vertex_ind")) triangles.add_polygon(corners);
    }
  }
  surface.mesh.triangles = triangles.triangles();
}

void skip_element(const Element& element, Cursor& cursor) {
  for (std::int64_t e = 0; e < element.count; ++e) {
    for (const Property& property : element.properties) {
      double n = property.count_type ? cursor.next(*property.count_type) : 1.0;
      for (; n > 0; --n) cursor.next(property.type);
    }
  }
}

template <class T>
void append(std::string& bytes, T value) {
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

}  // namespace

Surface parse_ply(std::string_view bytes, const std::string& source) {
  const Header header = parse_header(bytes, source);
  Cursor cursor(bytes.substr(header.size), header.encoding, source);
  Surface surface;
  for (const Element& element : header.elements) {
    // every value takes at least a byte: a larger count is a broken header, not a reason to
    // allocate
    if (static_cast<std::size_t>(element.count) > bytes.size()) {
      fail(ErrorCode::bad_file, source, " ends before its data are complete");
    }
    if (element.name == "vertex") {
      read_vertices(element, cursor, source, surface);
    } else if (element.name == "face") {
      read_faces(element, cursor, surface);
    } else {
      skip_element(element, cursor);
    }
  }
  return surface;
}

std::vector<std::string> ply_comments(std::string_view bytes) {
  return bytes.starts_with("ply") ? parse_header(bytes, "PLY file").comments
                                  : std::vector<std::string>{};
}

std::string format_ply(const Surface& surface) {
  const TriMesh& mesh = surface.mesh;
  std::ostringstream header;
  header << "ply\nformat binary_little_endian 1.0\ncomment units mm\ncomment frame LPS\n"
         << "element vertex " << mesh.n_vertices()
         << "\nproperty double x\nproperty double y\nproperty double z\n";
  for (const auto& [name, values] : surface.fields) header << "property double " << name << '\n';
  header << "element face " << mesh.n_triangles()
         << "\nproperty list uchar int vertex_indices\nend_header\n";

  std::string bytes = header.str();
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    for (int a = 0; a < 3; ++a) append(bytes, mesh.points(v, a));
    for (const auto& [name, values] : surface.fields) append(bytes, values[v]);
  }
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    append(bytes, std::uint8_t{3});
    for (int c = 0; c < 3; ++c) append(bytes, mesh.triangles(t, c));
  }
  return bytes;
}

}  // namespace coxa::io
