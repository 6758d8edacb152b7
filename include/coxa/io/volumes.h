#pragma once

#include <coxa/image/volume.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace coxa::io {

struct ReadVolumeOptions {
  /// Which series of a DICOM folder: its identifier as `list_dicom_series` gives it. Needed only
  /// where the folder holds several.
  std::optional<std::string> series;
};

/// Scalar image from NIfTI, NRRD, MetaImage (`.mha`), or a DICOM folder, in LPS mm.
///
/// A NIfTI whose sform code is 0 is placed by its qform. Scaling (slope, intercept) is applied.
/// @throws Error bad_file if missing or broken; bad_input if not a scalar 3-D image, if its axes
/// are not
///         orthogonal, or if a DICOM folder is not one whole stack (see dicom.h)
Volume read_volume(const std::filesystem::path& path, const ReadVolumeOptions& options = {});

/// How voxel values are stored.
enum class VoxelType { float32, int16, uint8 };

/// Writes `.nii`, `.nii.gz` or `.nrrd` (compressed). Integer types round.
/// @throws Error bad_input for another extension or a value outside the type; bad_file if it cannot
///         be written
void write_volume(const std::filesystem::path& path, const Volume& volume,
                  VoxelType type = VoxelType::float32);

}  // namespace coxa::io
