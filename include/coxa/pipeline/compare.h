#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/surface_distance.h>

#include <filesystem>
#include <map>
#include <string>

namespace coxa::pipeline {

/// Distances between the surfaces of the same name in two folders, or between two surface files
/// (named "surface").
/// @param image  an image whose field of view, 2 mm inside its border, limits what is judged;
/// empty: everything
/// @throws Error bad_input if no structure is in both
std::map<std::string, SurfaceDistance> compare(const std::filesystem::path& result,
                                               const std::filesystem::path& truth,
                                               const std::filesystem::path& image,
                                               const Monitor& monitor);

}  // namespace coxa::pipeline
