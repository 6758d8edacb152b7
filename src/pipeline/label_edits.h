#pragma once

#include <coxa/core/monitor.h>
#include <coxa/image/volume.h>
#include <coxa/mesh/surface_set.h>
#include <coxa/pipeline/record.h>

#include <filesystem>

namespace coxa::pipeline {

/// Surfaces follow a label map that was made of them and then corrected by hand; where the labels
/// are as they were nothing moves.
///
/// Structures whose voxels differ from those of their surface are moved to the labels' border and
/// get the field `edited` (mm moved); their overlap with the labels goes into the record.
/// @param grid  the image the surfaces were found in
/// @throws Error bad_input if the map lies on another grid, or names a structure that is not there
void follow_labels(const std::filesystem::path& path, const Volume& grid, SurfaceSet& surfaces,
                   Record& record, const Monitor& monitor);

}  // namespace coxa::pipeline
