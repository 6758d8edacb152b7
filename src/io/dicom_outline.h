#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace coxa::io {

/// What a walk along a DICOM file's data elements shows, before any decoder touches it.
struct DicomOutline {
  bool has_image = false;     ///< rows and columns are named: an image, not a report or a plan
  bool header_whole = false;  ///< every element before the pixels is there in full
  std::string fault;          ///< what is missing of header or pixels; empty: nothing
};

/// Walks a file that begins with the DICOM preamble from element to element up to the end of its
/// pixels.
///
/// Decoders abort, or read past the end, on a file cut short: this comes first. The pixels' length
/// is held against the file's size and against what rows, columns and bits need.
/// @note big-endian files and those deflated as a whole are taken to be whole
/// Source: DICOM PS3.5 sections 7.1 (elements), 7.5 (sequences), A.4 (fragments).
DicomOutline outline_dicom(const std::filesystem::path& file);

}  // namespace coxa::io
