#pragma once

#include <coxa/mesh/surface_set.h>
#include <coxa/pipeline/muscle_names.h>
#include <coxa/shape/registration.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace coxa::pipeline {

/// The muscles that a folder of surfaces holds.
SurfaceSet read_muscles(const std::filesystem::path& folder);

/// The muscles of one side of a label map (../shared/data/README.md gives its numbers). Those that
/// it merges, or shows a stump of only, are left out; vertices where the map ends have no trust.
std::map<std::string, shape::TrustedSurface> muscles_from_labels(const std::filesystem::path& path,
                                                                 Side side);

}  // namespace coxa::pipeline
