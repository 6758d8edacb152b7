#pragma once

#include <coxa/core/types.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "body_surface.h"

namespace coxa::serve {

/// Whether the joint stage has written frame `index` in this folder.
bool has_stored_frame(const std::filesystem::path& frames, Index index);

/// A solved frame for the page: positions and fields on the bodies' surfaces, and the femur's pose.
/// @param bodies  at rest, the femoral one among them
/// @throws Error bad_input where the frame is of other meshes; bad_file
std::string stored_frame(const std::filesystem::path& frames, Index index,
                         const std::vector<std::shared_ptr<const Body>>& bodies);

}  // namespace coxa::serve
