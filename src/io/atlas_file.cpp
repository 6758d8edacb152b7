#include <coxa/io/atlas_file.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "volume_formats.h"

namespace coxa::io {
namespace {

constexpr std::string_view kMagic = "coxa-atlas";
constexpr std::int32_t kFormat = 4;
// read too: it knew no muscles, and marked what is generic by one
constexpr std::int32_t kFormatWithoutMuscles = 3;
// kinds of a structure, in one byte
constexpr std::uint8_t kGeneric = 1, kMuscle = 2;
// no part of an atlas has more entries; a larger count means a broken file
constexpr std::int64_t kMostEntries = std::int64_t{1} << 28;

/// Values in sequence, the machine's own (little-endian) byte order.
class Writer {
 public:
  template <class T>
  void value(const T& v) {
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  void text(const std::string& s) {
    value(static_cast<std::int64_t>(s.size()));
    bytes_ += s;
  }
  /// Rows and columns, then 32-bit floats or integers.
  template <class Stored, class Matrix>
  void matrix(const Matrix& m) {
    value(static_cast<std::int64_t>(m.rows()));
    value(static_cast<std::int64_t>(m.cols()));
    for (Eigen::Index c = 0; c < m.cols(); ++c) {
      for (Eigen::Index r = 0; r < m.rows(); ++r) value(static_cast<Stored>(m(r, c)));
    }
  }
  /// Column by column as fractions of the column's largest value, in integers of type Code.
  template <class Code>
  void fractions(const MatX& m) {
    constexpr double kLargestCode = std::numeric_limits<Code>::max();
    value(static_cast<std::int64_t>(m.rows()));
    value(static_cast<std::int64_t>(m.cols()));
    for (Eigen::Index c = 0; c < m.cols(); ++c) {
      const double scale = m.rows() > 0 ? m.col(c).cwiseAbs().maxCoeff() / kLargestCode : 0.0;
      value(scale);
      for (Eigen::Index r = 0; r < m.rows(); ++r) {
        value(static_cast<Code>(scale > 0.0 ? std::lround(m(r, c) / scale) : 0));
      }
    }
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Reader {
 public:
  Reader(std::string bytes, const std::filesystem::path& path)
      : bytes_(std::move(bytes)), path_(path) {}
  template <class T>
  T value() {
    if (bytes_.size() - at_ < sizeof(T)) broken("it is cut short");
    T v;
    std::memcpy(&v, bytes_.data() + at_, sizeof v);
    at_ += sizeof v;
    return v;
  }
  std::int64_t count() {
    const auto n = value<std::int64_t>();
    if (n < 0 || n > kMostEntries) broken("a count is out of range");
    return n;
  }
  std::string text() {
    const auto n = static_cast<std::size_t>(count());
    if (bytes_.size() - at_ < n) broken("it is cut short");
    at_ += n;
    return bytes_.substr(at_ - n, n);
  }
  template <class Stored, class Matrix>
  Matrix matrix() {
    const auto rows = count(), columns = count();
    if (rows * columns > kMostEntries) broken("a matrix is too large");
    Matrix m(rows, columns);
    for (Eigen::Index c = 0; c < columns; ++c) {
      for (Eigen::Index r = 0; r < rows; ++r)
        m(r, c) = static_cast<typename Matrix::Scalar>(value<Stored>());
    }
    return m;
  }
  template <class Code>
  MatX fractions() {
    const auto rows = count(), columns = count();
    if (rows * columns > kMostEntries) broken("a matrix is too large");
    MatX m(rows, columns);
    for (Eigen::Index c = 0; c < columns; ++c) {
      const auto scale = value<double>();
      for (Eigen::Index r = 0; r < rows; ++r) m(r, c) = scale * value<Code>();
    }
    return m;
  }
  [[noreturn]] void broken(const std::string& why) const {
    fail(ErrorCode::bad_file, path_.string(), " is not a usable atlas: ", why, " (byte ", at_, ")");
  }

 private:
  std::string bytes_;
  std::filesystem::path path_;
  std::size_t at_ = 0;
};

void write_mesh(Writer& out, const SimplexMesh& mesh) {
  out.matrix<float>(mesh.points);
  out.matrix<std::int32_t>(mesh.neighbours);
  out.matrix<std::int32_t>(mesh.faces_of);
  out.value(mesh.n_faces);
}

SimplexMesh read_mesh(Reader& in) {
  SimplexMesh mesh;
  mesh.points = in.matrix<float, Points>();
  mesh.neighbours = in.matrix<std::int32_t, Triangles>();
  mesh.faces_of = in.matrix<std::int32_t, Triangles>();
  mesh.n_faces = in.value<Index>();
  const Index n = mesh.n_vertices();
  const bool fits = mesh.neighbours.rows() == n && mesh.faces_of.rows() == n && n > 0 &&
                    mesh.neighbours.minCoeff() >= 0 && mesh.neighbours.maxCoeff() < n &&
                    mesh.faces_of.minCoeff() >= 0 && mesh.faces_of.maxCoeff() < mesh.n_faces;
  if (!fits) in.broken("a mesh does not fit together");
  return mesh;
}

void write_profiles(Writer& out, const shape::ProfileSet& set) {
  out.text(set.contrast);
  out.value(set.step);
  out.value(set.n_inside);
  out.fractions<std::int8_t>(set.mean);
  out.matrix<float>(set.reliability);
}

shape::ProfileSet read_profiles(Reader& in) {
  shape::ProfileSet set;
  set.contrast = in.text();
  set.step = in.value<double>();
  set.n_inside = in.value<Index>();
  set.mean = in.fractions<std::int8_t>();
  set.reliability = in.matrix<float, VecX>();
  return set;
}

std::vector<SimplexParameters> reference_of(const SimplexMesh& mesh) {
  std::vector<SimplexParameters> parameters;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const auto corner = [&](int k) { return Vec3(mesh.points.row(mesh.neighbours(v, k))); };
    parameters.push_back(simplex_parameters(mesh.points.row(v), corner(0), corner(1), corner(2)));
  }
  return parameters;
}

void write_structure(Writer& out, const shape::StructureModel& model) {
  out.text(model.name);
  out.value(static_cast<std::int64_t>(model.hierarchy.levels.size()));
  for (const SimplexMesh& level : model.hierarchy.levels) write_mesh(out, level);
  for (const LevelMap& map : model.hierarchy.maps) {
    out.matrix<std::int32_t>(map.parents);
    out.matrix<float>(map.weights);
  }
  out.fractions<std::int16_t>(model.shape.modes);
  out.matrix<float>(model.shape.deviations);
  out.value(static_cast<std::int64_t>(model.profiles.size()));
  for (const shape::ProfileSet& set : model.profiles) write_profiles(out, set);
  out.value(
      static_cast<std::uint8_t>((model.generic ? kGeneric : 0) + (model.muscle ? kMuscle : 0)));
  out.value(model.n_bone_side);
  out.value(static_cast<std::int64_t>(model.landmark_vertices.size()));
  for (const auto& [name, vertex] : model.landmark_vertices) {
    out.text(name);
    out.value(vertex);
  }
  out.value(model.leave_one_out_error);
}

shape::StructureModel read_structure(Reader& in) {
  shape::StructureModel model;
  model.name = in.text();
  const auto n_levels = in.count();
  for (std::int64_t l = 0; l < n_levels; ++l) model.hierarchy.levels.push_back(read_mesh(in));
  for (std::int64_t l = 0; l + 1 < n_levels; ++l) {
    LevelMap map;
    map.parents = in.matrix<std::int32_t, Triangles>();
    map.weights = in.matrix<float, Points>();
    model.hierarchy.maps.push_back(std::move(map));
  }
  model.shape.modes = in.fractions<std::int16_t>();
  // rounding to 16 bits leaves the columns' length off by parts in a hundred thousand
  for (Eigen::Index c = 0; c < model.shape.modes.cols(); ++c) model.shape.modes.col(c).normalize();
  model.shape.deviations = in.matrix<float, VecX>();
  const auto n_sets = in.count();
  for (std::int64_t i = 0; i < n_sets; ++i) model.profiles.push_back(read_profiles(in));
  model.reference = reference_of(model.hierarchy.levels.back());
  const auto kind = in.value<std::uint8_t>();
  model.generic = (kind & kGeneric) != 0;
  model.muscle = (kind & kMuscle) != 0;
  model.n_bone_side = in.value<Index>();
  for (auto n = in.count(); n > 0; --n) {
    const std::string name = in.text();
    model.landmark_vertices[name] = in.value<Index>();
  }
  model.leave_one_out_error = in.value<double>();
  return model;
}

}  // namespace

void write_atlas(const std::filesystem::path& path, const shape::Atlas& atlas) {
  Writer out;
  out.value(kFormat);
  out.text(atlas.attribution);
  out.value(static_cast<std::int64_t>(atlas.subjects.size()));
  for (const std::string& subject : atlas.subjects) out.text(subject);
  out.value(static_cast<std::int64_t>(atlas.landmarks.size()));
  for (const auto& [name, p] : atlas.landmarks) {
    out.text(name);
    out.matrix<double>(p);
  }
  out.value(static_cast<std::int64_t>(atlas.structures.size()));
  for (const shape::StructureModel& model : atlas.structures) write_structure(out, model);
  write_bytes(path, std::string(kMagic) + gzipped(out.bytes()));
}

shape::Atlas read_atlas(const std::filesystem::path& path) {
  const std::string file = read_bytes(path);
  if (file.compare(0, kMagic.size(), kMagic) != 0) {
    fail(ErrorCode::bad_file, path.string(), " is not an atlas of coxa");
  }
  Reader in(inflated(std::string_view(file).substr(kMagic.size()), path.string()), path);
  const auto format = in.value<std::int32_t>();
  if (format != kFormat && format != kFormatWithoutMuscles)
    in.broken(join_text("format ", format, ", this coxa reads ", kFormat));
  shape::Atlas atlas;
  atlas.attribution = in.text();
  for (auto n = in.count(); n > 0; --n) atlas.subjects.push_back(in.text());
  for (auto n = in.count(); n > 0; --n) {
    const std::string name = in.text();
    atlas.landmarks[name] = in.matrix<double, Vec3>();
  }
  for (auto n = in.count(); n > 0; --n) atlas.structures.push_back(read_structure(in));
  return atlas;
}

}  // namespace coxa::io
