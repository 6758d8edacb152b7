#pragma once

#include <coxa/core/types.h>

#include <Eigen/Geometry>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace coxa::io {

/// What the header of one DICOM image says of its place.
struct DicomSlice {
  std::filesystem::path file;
  std::string series_uid, series_number, description, modality, echo, image_type;
  int instance = 0, frames = 1, columns = 0, rows = 0;
  Vec3 position = Vec3::Zero();  ///< LPS mm, centre of the first pixel
  Vec3 row_axis = Vec3::UnitX(), column_axis = Vec3::UnitY();
  double column_spacing = 1.0, row_spacing = 1.0;  ///< mm between columns, between rows
  double thickness = kNaN;                         ///< mm
  std::string fault;  ///< why its pixels are not whole; empty if they are

  Vec3 normal() const { return row_axis.cross(column_axis); }
};

/// nullopt if the file is not DICOM or is a DICOM object without pixels.
/// @throws Error bad_file if it is DICOM and broken, or lacks its position
std::optional<DicomSlice> read_dicom_header(const std::filesystem::path& file);

/// Pixels of one slice, rows*columns values, slope and intercept applied.
/// @throws Error bad_file if they cannot be decoded or have another size, bad_input if they are
/// colours
std::vector<float> read_dicom_pixels(const std::filesystem::path& file, int columns, int rows);

}  // namespace coxa::io
