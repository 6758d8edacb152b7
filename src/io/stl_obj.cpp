#include <coxa/core/error.h>

#include "surface_formats.h"

#include <Eigen/Geometry>

#include <array>
#include <charconv>
#include <cstring>
#include <map>
#include <sstream>

namespace coxa::io {
namespace {

constexpr std::size_t kStlHeader = 84;  ///< 80 bytes of text and the number of triangles
constexpr std::size_t kStlRecord = 50;  ///< normal, three corners, two spare bytes

/// Gives equal positions one number, in order of first appearance.
class VertexMerger {
 public:
  Index number_of(const Vec3& p) {
    const auto [entry, is_new] =
        numbers_.try_emplace({p[0], p[1], p[2]}, static_cast<Index>(flat_.size() / 3));
    if (is_new) flat_.insert(flat_.end(), {p[0], p[1], p[2]});
    return entry->second;
  }
  Points points() const { return points_from(flat_); }

 private:
  std::map<std::array<double, 3>, Index> numbers_;
  std::vector<double> flat_;
};

/// Triangles whose corners fell together by merging are dropped.
TriMesh merged_mesh(const std::vector<Vec3>& corners) {
  VertexMerger merger;
  TriangleList triangles;
  for (std::size_t c = 0; c + 2 < corners.size(); c += 3) {
    const Index a = merger.number_of(corners[c]), b = merger.number_of(corners[c + 1]),
                d = merger.number_of(corners[c + 2]);
    if (a != b && b != d && d != a) triangles.add_polygon({a, b, d});
  }
  return {merger.points(), triangles.triangles()};
}

std::uint32_t stl_count(std::string_view bytes) {
  std::uint32_t n = 0;
  if (bytes.size() >= kStlHeader) std::memcpy(&n, bytes.data() + 80, 4);
  return n;
}

std::vector<Vec3> binary_corners(std::string_view bytes) {
  std::vector<Vec3> corners;
  const std::uint32_t n = stl_count(bytes);
  for (std::uint32_t t = 0; t < n; ++t) {
    std::array<float, 12> record;
    std::memcpy(record.data(), bytes.data() + kStlHeader + kStlRecord * t, sizeof(record));
    for (std::size_t c = 1; c < 4; ++c) {
      corners.emplace_back(record[3 * c], record[3 * c + 1], record[3 * c + 2]);
    }
  }
  return corners;
}

/// The three numbers at the start of `text`; nullopt-like false when they are not there.
bool parse_three(std::string_view text, Vec3& p) {
  const char* at = text.data();
  const char* end = at + text.size();
  for (int a = 0; a < 3; ++a) {
    while (at < end && static_cast<unsigned char>(*at) <= ' ') ++at;
    if (at < end && *at == '+') ++at;
    const auto [next, status] = std::from_chars(at, end, p[a]);
    if (status != std::errc()) return false;
    at = next;
  }
  return true;
}

/// Calls f(line, number) for every line, without leading blanks.
template <class F>
void for_each_line(std::string_view bytes, const F& f) {
  for (std::size_t number = 1; !bytes.empty(); ++number) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string_view line = bytes.substr(0, end);
    line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
    f(line, number);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
  }
}

std::vector<Vec3> ascii_corners(std::string_view bytes, const std::string& source) {
  std::vector<Vec3> corners;
  for_each_line(bytes, [&](std::string_view line, std::size_t number) {
    if (!line.starts_with("vertex")) return;
    Vec3 p;
    if (!parse_three(line.substr(6), p)) {
      fail(ErrorCode::bad_file, source, ":", number, ": an STL vertex needs three numbers");
    }
    corners.push_back(p);
  });
  if (corners.size() % 3 != 0 || bytes.rfind("endsolid") == std::string_view::npos) {
    fail(ErrorCode::bad_file, source, " ends before its data are complete");
  }
  return corners;
}

/// Vertex numbers of an OBJ face: "3", "3/1", "3//2", or counted from the last vertex, "-1".
std::vector<Index> obj_corners(std::string_view text, Index n_points, const std::string& source,
                               std::size_t number) {
  std::vector<Index> corners;
  std::istringstream words{std::string(text)};
  for (std::string word; words >> word;) {
    if (word[0] == '#') break;
    Index i = 0;
    const auto status = std::from_chars(word.data(), word.data() + word.size(), i).ec;
    if (status != std::errc() || i == 0) {
      fail(ErrorCode::bad_file, source, ":", number, ": '", word, "' is not a vertex of a face");
    }
    corners.push_back(i > 0 ? i - 1 : n_points + i);
  }
  return corners;
}

template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

}  // namespace

TriMesh parse_stl(std::string_view bytes, const std::string& source) {
  const std::size_t binary_size =
      kStlHeader + kStlRecord * static_cast<std::size_t>(stl_count(bytes));
  if (bytes.size() >= kStlHeader && bytes.size() == binary_size)
    return merged_mesh(binary_corners(bytes));
  if (bytes.starts_with("solid")) return merged_mesh(ascii_corners(bytes, source));
  fail(ErrorCode::bad_file, source, " is neither ASCII STL nor whole binary STL: ", bytes.size(),
       " bytes, ", binary_size, " expected");
}

TriMesh parse_obj(std::string_view bytes, const std::string& source) {
  std::vector<double> flat;
  TriangleList triangles;
  for_each_line(bytes, [&](std::string_view line, std::size_t number) {
    if (line.starts_with("v ")) {
      Vec3 p;
      if (!parse_three(line.substr(1), p)) {
        fail(ErrorCode::bad_file, source, ":", number, ": an OBJ vertex needs three numbers");
      }
      flat.insert(flat.end(), {p[0], p[1], p[2]});
    } else if (line.starts_with("f ")) {
      triangles.add_polygon(
          obj_corners(line.substr(1), static_cast<Index>(flat.size() / 3), source, number));
    }
  });
  return {points_from(flat), triangles.triangles()};
}

std::string format_stl(const TriMesh& mesh) {
  std::string bytes = "coxa surface, LPS mm";
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(mesh.n_triangles()));
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    std::array<Vec3, 4> record;
    for (std::size_t c = 0; c < 3; ++c) {
      record[c + 1] = mesh.points.row(mesh.triangles(t, static_cast<Index>(c)));
    }
    record[0] = (record[2] - record[1]).cross(record[3] - record[1]).stableNormalized();
    for (const Vec3& p : record) {
      for (int a = 0; a < 3; ++a) append(bytes, static_cast<float>(p[a]));
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string format_obj(const TriMesh& mesh) {
  std::ostringstream text;
  text.precision(17);
  text << "# units mm, frame LPS\n";
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    text << "v " << mesh.points(v, 0) << ' ' << mesh.points(v, 1) << ' ' << mesh.points(v, 2)
         << '\n';
  }
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    text << "f " << mesh.triangles(t, 0) + 1 << ' ' << mesh.triangles(t, 1) + 1 << ' '
         << mesh.triangles(t, 2) + 1 << '\n';
  }
  return text.str();
}

}  // namespace coxa::io
