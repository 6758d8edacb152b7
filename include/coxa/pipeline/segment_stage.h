#pragma once

#include <coxa/core/monitor.h>
#include <coxa/image/volume.h>
#include <coxa/mesh/surface_set.h>
#include <coxa/pipeline/stage.h>
#include <coxa/pipeline/subject.h>
#include <coxa/segment/segment.h>

#include <filesystem>
#include <vector>

namespace coxa::pipeline {

struct SegmentRequest {
  std::vector<ImageEntry> images;
  Side side = Side::right;
  std::filesystem::path landmarks;  ///< empty: none
  std::filesystem::path atlas;
  segment::SegmentOptions options;
  std::filesystem::path pins = {};  ///< points named `<structure>-<n>`; empty: none
  double pin_weight = 1.0;          ///< of each, see segment::Pin
  /// `labels.nii.gz` (or .seg.nrrd) of an earlier result, corrected by hand; empty: none
  std::filesystem::path labels = {};
};

/// Segments the images into `folder`: one VTP and PLY per structure, `labels.nii.gz` with
/// `labels.json`, `thickness` fields on the cartilages, and the record `segment.json`.
///
/// With pins or edited labels the surfaces as found in the image are kept in `folder/found`: other
/// corrections are made on these, without another search. Labrum and ligaments among the structures
/// are generic and made last.
Record run_segment_stage(const SegmentRequest& request, const std::filesystem::path& folder,
                         Reuse reuse, const Monitor& monitor);

/// The image of an entry. Of a DICOM folder with several series and none selected, the one whole
/// stack that holds every landmark is taken.
/// @throws Error bad_input listing the series where the choice is not clear
Volume read_image(const ImageEntry& entry, const shape::Landmarks& landmarks,
                  const Monitor& monitor);

/// Adds the cartilages' thickness to their bones as a field: from the bone out to the articular
/// surface, mm.
void add_thickness(SurfaceSet& surfaces);

/// The bones and cartilages a segment stage left in `folder`, by structure.
/// @throws Error bad_file if there is none
SurfaceSet read_surfaces(const std::filesystem::path& folder);

}  // namespace coxa::pipeline
