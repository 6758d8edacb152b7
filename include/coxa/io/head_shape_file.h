#pragma once

#include <coxa/motion/head_shape.h>

#include <filesystem>

namespace coxa::io {

/// Mean shape of femoral heads as TOML: `degree`, `mean`, `spread`, `source`
/// (data/femoral_head.toml).
/// @throws Error bad_file, bad_input
motion::HeadShape read_head_shape(const std::filesystem::path& path);
void write_head_shape(const std::filesystem::path& path, const motion::HeadShape& shape);

}  // namespace coxa::io
