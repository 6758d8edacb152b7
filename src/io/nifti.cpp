#include <coxa/core/error.h>

#include "volume_formats.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace coxa::io {
namespace {

constexpr std::size_t kHeaderSize = 348;

/// NIfTI-1 header, 348 bytes in this order. Source: nifti1.h of the NIfTI-1.1 standard.
struct NiftiHeader {
  std::int32_t sizeof_hdr = kHeaderSize;
  std::array<char, 36> analyze_fields{};
  std::array<std::int16_t, 8> dim{};
  std::array<float, 3> intent_parameters{};
  std::int16_t intent_code = 0, datatype = 0, bitpix = 0, slice_start = 0;
  std::array<float, 8> pixdim{};
  float vox_offset = 352.0F, scl_slope = 1.0F, scl_inter = 0.0F;
  std::int16_t slice_end = 0;
  char slice_code = 0, xyzt_units = 2;  ///< 2: millimetres
  std::array<float, 4> display_and_timing{};
  std::array<std::int32_t, 2> gl_limits{};
  std::array<char, 80> descrip{};
  std::array<char, 24> aux_file{};
  std::int16_t qform_code = 1, sform_code = 1;
  std::array<float, 3> quaternion{};
  std::array<float, 3> quaternion_offset{};
  std::array<std::array<float, 4>, 3> srow{};
  std::array<char, 16> intent_name{};
  std::array<char, 4> magic{'n', '+', '1', '\0'};
};
static_assert(sizeof(NiftiHeader) == kHeaderSize);

template <class T>
void update_swapped(T& value) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  std::reverse(raw.begin(), raw.end());
  value = std::bit_cast<T>(raw);
}

/// Swaps the bytes of every field that is read below.
void update_swapped(NiftiHeader& header) {
  for (auto& value : header.dim) update_swapped(value);
  for (auto& value : header.pixdim) update_swapped(value);
  for (auto* value : {&header.datatype, &header.qform_code, &header.sform_code})
    update_swapped(*value);
  for (auto* value : {&header.vox_offset, &header.scl_slope, &header.scl_inter})
    update_swapped(*value);
  for (auto& value : header.quaternion) update_swapped(value);
  for (auto& value : header.quaternion_offset) update_swapped(value);
  for (auto& row : header.srow) {
    for (auto& value : row) update_swapped(value);
  }
}

struct Placement {
  Mat3 axes;  ///< RAS, columns: step of one voxel
  Vec3 origin;
};

Placement placement_by_sform(const NiftiHeader& header) {
  Placement placement;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto row = static_cast<Index>(r);
    for (Index c = 0; c < 3; ++c)
      placement.axes(row, c) = header.srow[r][static_cast<std::size_t>(c)];
    placement.origin[row] = header.srow[r][3];
  }
  return placement;
}

Placement placement_by_qform(const NiftiHeader& header) {
  const Vec3 v(header.quaternion[0], header.quaternion[1], header.quaternion[2]);
  const double w = std::sqrt(std::max(0.0, 1.0 - v.squaredNorm()));
  const Eigen::Quaterniond q = Eigen::Quaterniond(w, v[0], v[1], v[2]).normalized();
  const Vec3 step(header.pixdim[1], header.pixdim[2],
                  header.pixdim[0] < 0.0F ? -header.pixdim[3] : header.pixdim[3]);
  return {
      q.toRotationMatrix() * step.asDiagonal(),
      Vec3(header.quaternion_offset[0], header.quaternion_offset[1], header.quaternion_offset[2])};
}

/// The sform where its code says that it is set, else the qform, else the voxel sizes alone.
Placement placement_of(const NiftiHeader& header) {
  if (header.sform_code > 0) return placement_by_sform(header);
  if (header.qform_code > 0) return placement_by_qform(header);
  const Vec3 step(header.pixdim[1], header.pixdim[2], header.pixdim[3]);
  return {step.asDiagonal(), Vec3::Zero()};
}

double millimetres_per_unit(char xyzt_units) {
  const int unit = xyzt_units & 7;
  if (unit == 1) return 1000.0;
  return unit == 3 ? 1e-3 : 1.0;
}

ScalarType type_of(std::int16_t datatype, const std::string& source) {
  switch (datatype) {
    case 2:
      return ScalarType::u8;
    case 4:
      return ScalarType::i16;
    case 8:
      return ScalarType::i32;
    case 16:
      return ScalarType::f32;
    case 64:
      return ScalarType::f64;
    case 256:
      return ScalarType::i8;
    case 512:
      return ScalarType::u16;
    case 768:
      return ScalarType::u32;
    case 1024:
      return ScalarType::i64;
    case 1280:
      return ScalarType::u64;
    default:
      fail(ErrorCode::bad_input, source, " stores voxels of NIfTI type ", datatype,
           "; a scalar image is needed");
  }
}

/// NIfTI keeps a rotation and the sign of the third axis (pixdim[0]).
void set_qform(const Mat3& axes_ras, const Vec3& origin_ras, NiftiHeader& header) {
  Mat3 rotation = axes_ras;
  const bool mirrored = rotation.determinant() < 0.0;
  if (mirrored) rotation.col(2) *= -1.0;
  header.pixdim[0] = mirrored ? -1.0F : 1.0F;
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    header.quaternion[a] = static_cast<float>(q.vec()[static_cast<Index>(a)]);
    header.quaternion_offset[a] = static_cast<float>(origin_ras[static_cast<Index>(a)]);
  }
}

const Vec3 kLpsToRas(-1.0, -1.0, 1.0);

}  // namespace

Volume parse_nifti(std::string_view bytes, const std::string& source) {
  NiftiHeader header;
  if (bytes.size() < kHeaderSize) fail(ErrorCode::bad_file, source, " is too short for NIfTI");
  std::memcpy(&header, bytes.data(), kHeaderSize);
  StoredImage image;
  if (header.sizeof_hdr != static_cast<std::int32_t>(kHeaderSize)) {
    update_swapped(header);
    image.big_endian = true;
  }
  if (std::memcmp(header.magic.data(), "n+1", 4) != 0) {
    fail(ErrorCode::bad_file, source, " is not NIfTI-1 in a single file");
  }
  if (header.dim[0] < 1 || header.dim[0] > 7) {
    fail(ErrorCode::bad_file, source, ": NIfTI header with ", header.dim[0], " axes");
  }
  image.size.assign(header.dim.begin() + 1, header.dim.begin() + 1 + header.dim[0]);
  const Placement placement = placement_of(header);
  const double unit = millimetres_per_unit(header.xyzt_units);
  image.axes = unit * (kLpsToRas.asDiagonal() * placement.axes);
  image.origin = unit * kLpsToRas.cwiseProduct(placement.origin);
  image.type = type_of(header.datatype, source);
  if (header.scl_slope != 0.0F && std::isfinite(header.scl_slope)) {
    image.slope = header.scl_slope;
    image.intercept = header.scl_inter;
  }
  const auto offset = static_cast<std::size_t>(std::max(0.0F, header.vox_offset));
  image.voxels = bytes.substr(std::min(offset, bytes.size()));
  return make_volume(image, source);
}

std::string format_nifti(const Volume& volume, VoxelType type, const std::string& target) {
  NiftiHeader header;
  header.dim = {3, 1, 1, 1, 1, 1, 1, 1};
  header.datatype = type == VoxelType::float32 ? 16 : type == VoxelType::int16 ? 4 : 2;
  header.bitpix = type == VoxelType::float32 ? 32 : type == VoxelType::int16 ? 16 : 8;
  const Mat3 axes = kLpsToRas.asDiagonal() * volume.direction;
  const Vec3 origin = kLpsToRas.cwiseProduct(volume.origin);
  set_qform(axes, origin, header);
  for (Index a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    require(volume.size[i] <= std::numeric_limits<std::int16_t>::max(), "axis ", a, " of ", target,
            " has ", volume.size[i], " voxels, NIfTI-1 allows 32767");
    header.dim[i + 1] = static_cast<std::int16_t>(volume.size[i]);
    header.pixdim[i + 1] = static_cast<float>(volume.spacing[a]);
    for (Index c = 0; c < 3; ++c) {
      header.srow[i][static_cast<std::size_t>(c)] =
          static_cast<float>(axes(a, c) * volume.spacing[c]);
    }
    header.srow[i][3] = static_cast<float>(origin[a]);
  }
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof(header));
  bytes.append(4, '\0');  // no extension
  return bytes + voxel_bytes(volume, type, target);
}

}  // namespace coxa::io
