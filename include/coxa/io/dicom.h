#pragma once

#include <coxa/image/volume.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace coxa::io {

/// One series of a DICOM folder: what it says of itself, where it lies, and whether it is one whole
/// stack.
struct DicomSeries {
  std::string id;           ///< selects the series; its number where that is unique, else its UID
  std::string uid;          ///< Series Instance UID
  std::string description;  ///< empty where anonymised
  std::string modality;
  double slice_thickness = kNaN;             ///< mm, as in the header; NaN where it does not say
  std::vector<std::filesystem::path> files;  ///< in order along the normal
  Volume grid;                               ///< geometry, without values
  std::string problem;  ///< why it cannot be read as one stack; empty if it can

  bool usable() const { return problem.empty(); }
};

/// All image series in a folder and its subfolders, by series number then UID.
///
/// Files that are not DICOM, and DICOM objects without pixels (RTSTRUCT, reports), are passed over.
/// A series has a `problem` if it holds few slices, mixed orientations or sizes, a slice twice, a
/// gap, uneven or sheared steps, or slices far apart for their thickness (a localizer).
/// @throws Error bad_file if the folder does not exist or a DICOM file is broken
std::vector<DicomSeries> list_dicom_series(const std::filesystem::path& folder);

/// Those usable series whose field of view holds every point (n×3, LPS mm).
std::vector<DicomSeries> series_holding(const std::vector<DicomSeries>& series,
                                        const Points& points);

/// One line: id, description, slices, voxel size, extent, problem.
std::string describe(const DicomSeries& series);

/// The voxels of one series.
/// @throws Error bad_input with its problem if it is not usable; bad_file if pixels cannot be
/// decoded
Volume read_series(const DicomSeries& series);

/// The only series of a folder, or the one selected by id, number or UID.
/// @throws Error bad_input if there are several and none is selected, or none matches (they are
/// listed)
Volume read_dicom(const std::filesystem::path& folder,
                  const std::optional<std::string>& selected = {});

}  // namespace coxa::io
