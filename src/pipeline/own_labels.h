#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/surface_set.h>

#include <filesystem>
#include <map>
#include <string>

namespace coxa::pipeline {

/// Structures of one hip from a label map with names (`io::read_labels`).
struct OwnLabels {
  SurfaceSet surfaces;                ///< smooth, closed, LPS mm; of the names that an atlas knows
  std::map<std::string, VecX> trust;  ///< 0 where the map's border cuts a structure; else none
};

/// @throws Error bad_input if no label has the name of a structure; else as io::read_labels
OwnLabels read_own_labels(const std::filesystem::path& path);

}  // namespace coxa::pipeline
