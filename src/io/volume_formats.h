#pragma once

#include <coxa/image/volume.h>
#include <coxa/io/volumes.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace coxa::io {

enum class ScalarType { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

/// An image as a file has it, before conversion to LPS floats.
struct StoredImage {
  std::vector<std::int64_t> size;  ///< every axis, the first fastest
  Mat3 axes = Mat3::Identity();    ///< columns: step of one voxel along each axis, LPS mm
  Vec3 origin = Vec3::Zero();      ///< LPS mm
  ScalarType type = ScalarType::f32;
  std::string_view voxels;  ///< bytes, at least as many as the size asks for
  double slope = 1.0, intercept = 0.0;
  bool big_endian = false;
};

/// Parsers take the bytes of a file; `source` is what error texts call it.
Volume parse_nifti(std::string_view bytes, const std::string& source);
Volume parse_nrrd(std::string_view bytes, const std::string& source);
Volume parse_meta_image(std::string_view bytes, const std::string& source);

/// "key:=value" lines of an NRRD header, in the file's order.
std::vector<std::pair<std::string, std::string>> nrrd_key_values(std::string_view bytes);

/// Floats on an orthogonal LPS grid.
/// @throws Error bad_input if it is not one scalar 3-D image or is sheared; bad_file if bytes lack
Volume make_volume(const StoredImage& image, const std::string& source);

/// The nearest orthonormal axes (columns); @throws Error bad_input if they are sheared or scaled.
Mat3 orthonormal_axes(const Mat3& axes, const std::string& source);
/// @throws Error bad_input or bad_file if the grid or a value is impossible
void check_volume(const Volume& volume, const std::string& source);

/// Voxels as stored; @throws Error bad_input if a value does not fit the type.
std::string voxel_bytes(const Volume& volume, VoxelType type, const std::string& target);
/// NIfTI-1 single file, RAS mm in qform and sform. `target` is what error texts call it.
std::string format_nifti(const Volume& volume, VoxelType type, const std::string& target);
/// NRRD with gzip encoding, space LPS, and further "key:=value" lines.
std::string format_nrrd(const Volume& volume, VoxelType type,
                        const std::vector<std::pair<std::string, std::string>>& extra,
                        const std::string& target);

/// Gzip stream without time stamp: the same bytes for the same input.
std::string gzipped(std::string_view bytes);
/// Content of a gzip or zlib stream. @throws Error bad_file if it is broken
std::string inflated(std::string_view bytes, const std::string& source);

}  // namespace coxa::io
