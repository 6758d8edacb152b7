#include <coxa/core/error.h>

#include "volume_formats.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace coxa::io {
namespace {

/// Largest entry of AᵀA - I for unit axes A that is put down to rounding in a header.
constexpr double kAxisTolerance = 1e-3;

static_assert(std::endian::native == std::endian::little);

template <class T>
std::vector<float> converted(const StoredImage& image, std::size_t n, const std::string& source) {
  if (image.voxels.size() < n * sizeof(T)) {
    fail(ErrorCode::bad_file, source, " is incomplete: ", image.voxels.size(), " bytes of voxels, ",
         n * sizeof(T), " expected");
  }
  std::vector<float> values(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), image.voxels.data() + i * sizeof(T), sizeof(T));
    if (image.big_endian) std::reverse(raw.begin(), raw.end());
    values[i] = static_cast<float>(image.slope * static_cast<double>(std::bit_cast<T>(raw)) +
                                   image.intercept);
  }
  return values;
}

std::vector<float> converted_voxels(const StoredImage& image, std::size_t n,
                                    const std::string& source) {
  switch (image.type) {
    case ScalarType::i8:
      return converted<std::int8_t>(image, n, source);
    case ScalarType::u8:
      return converted<std::uint8_t>(image, n, source);
    case ScalarType::i16:
      return converted<std::int16_t>(image, n, source);
    case ScalarType::u16:
      return converted<std::uint16_t>(image, n, source);
    case ScalarType::i32:
      return converted<std::int32_t>(image, n, source);
    case ScalarType::u32:
      return converted<std::uint32_t>(image, n, source);
    case ScalarType::i64:
      return converted<std::int64_t>(image, n, source);
    case ScalarType::u64:
      return converted<std::uint64_t>(image, n, source);
    case ScalarType::f32:
      return converted<float>(image, n, source);
    case ScalarType::f64:
      return converted<double>(image, n, source);
  }
  return {};
}

template <class T>
std::string integer_bytes(const Volume& volume, const std::string& target) {
  std::string bytes(volume.values.size() * sizeof(T), '\0');
  for (std::size_t i = 0; i < volume.values.size(); ++i) {
    const float value = std::round(volume.values[i]);
    require(value >= static_cast<float>(std::numeric_limits<T>::min()) &&
                value <= static_cast<float>(std::numeric_limits<T>::max()),
            "voxel value ", volume.values[i], " does not fit the ", 8 * sizeof(T),
            "-bit integers of ", target);
    const T stored = static_cast<T>(value);
    std::memcpy(bytes.data() + i * sizeof(T), &stored, sizeof(T));
  }
  return bytes;
}

}  // namespace

Mat3 orthonormal_axes(const Mat3& axes, const std::string& source) {
  const double skew = (axes.transpose() * axes - Mat3::Identity()).cwiseAbs().maxCoeff();
  require(skew <= kAxisTolerance, source, ": the axes of the grid are not orthogonal (off by ",
          skew, ", limit ", kAxisTolerance, "); resample the image to an orthogonal grid");
  // polar decomposition by Newton's iteration; from this near it is exact to rounding in three
  // steps
  Mat3 rotation = axes;
  for (int step = 0; step < 3; ++step)
    rotation = 0.5 * (rotation + rotation.inverse().transpose()).eval();
  return rotation;
}

void check_volume(const Volume& volume, const std::string& source) {
  require(volume.n_voxels() > 0, source, " holds no voxel");
  require(volume.spacing.allFinite() && volume.spacing.minCoeff() > 0.0, source,
          ": voxel size must be positive, got ", volume.spacing.transpose(), " mm");
  require(volume.origin.allFinite(), source, ": the origin is not finite");
  for (const float value : volume.values) {
    if (!std::isfinite(value)) fail(ErrorCode::bad_file, source, ": a voxel is not finite");
  }
}

Volume make_volume(const StoredImage& image, const std::string& source) {
  require(image.size.size() >= 3, source, " has ", image.size.size(),
          " axes; a 3-D image is needed");
  Volume volume;
  std::size_t n = 1;
  for (std::size_t a = 0; a < image.size.size(); ++a) {
    const std::int64_t size = image.size[a];
    require(a < 3 || size == 1, source, " holds ", size, " volumes; one is needed");
    require(size > 0 && size <= std::numeric_limits<std::int16_t>::max(), source, ": axis ", a,
            " has ", size, " voxels");
    n *= static_cast<std::size_t>(size);
    if (a < 3) volume.size[a] = static_cast<Index>(size);
  }
  volume.origin = image.origin;
  volume.spacing = image.axes.colwise().norm();
  require(volume.spacing.allFinite() && volume.spacing.minCoeff() > 0.0, source,
          ": voxel size must be positive, got ", volume.spacing.transpose(), " mm");
  volume.direction =
      orthonormal_axes(image.axes * volume.spacing.cwiseInverse().asDiagonal(), source);
  volume.values = converted_voxels(image, n, source);
  check_volume(volume, source);
  return volume;
}

std::string voxel_bytes(const Volume& volume, VoxelType type, const std::string& target) {
  if (type == VoxelType::int16) return integer_bytes<std::int16_t>(volume, target);
  if (type == VoxelType::uint8) return integer_bytes<std::uint8_t>(volume, target);
  return {reinterpret_cast<const char*>(volume.values.data()),
          volume.values.size() * sizeof(float)};
}

}  // namespace coxa::io
