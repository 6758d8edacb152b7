#pragma once

#include <nlohmann/json.hpp>

namespace coxa::serve {

/// The bands of `data/normal_curves.toml`: [{"movement", "angle", "source", "percent", "low",
/// "high"}].
/// @throws Error bad_input naming line and key of what is wrong in the file
nlohmann::json normal_curves();

}  // namespace coxa::serve
