#include <coxa/io/volumes.h>

#include <coxa/core/error.h>
#include <coxa/io/dicom.h>
#include <coxa/io/files.h>

#include "volume_formats.h"

namespace coxa::io {

namespace fs = std::filesystem;

Volume read_volume(const fs::path& path, const ReadVolumeOptions& options) {
  if (fs::is_directory(path)) return read_dicom(path, options.series);
  const std::string extension = extension_of(path);
  const std::string source = path.string();
  if (extension == ".nii") return parse_nifti(read_bytes(path), source);
  if (extension == ".nii.gz") return parse_nifti(inflated(read_bytes(path), source), source);
  if (extension == ".nrrd" || extension == ".seg.nrrd") return parse_nrrd(read_bytes(path), source);
  if (extension == ".mha") return parse_meta_image(read_bytes(path), source);
  fail(ErrorCode::bad_input, "cannot read an image from ", source,
       ": known are .nii, .nii.gz, .nrrd, .mha and a folder of DICOM slices");
}

void write_volume(const fs::path& path, const Volume& volume, VoxelType type) {
  const std::string extension = extension_of(path);
  const std::string target = path.string();
  COXA_ASSERT(static_cast<std::int64_t>(volume.values.size()) == volume.n_voxels());
  if (extension == ".nii") return write_bytes(path, format_nifti(volume, type, target));
  if (extension == ".nii.gz") return write_bytes(path, gzipped(format_nifti(volume, type, target)));
  if (extension == ".nrrd") return write_bytes(path, format_nrrd(volume, type, {}, target));
  fail(ErrorCode::bad_input, "cannot write an image to ", target,
       ": known are .nii, .nii.gz, .nrrd");
}

}  // namespace coxa::io
