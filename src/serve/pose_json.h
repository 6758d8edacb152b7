#pragma once

#include <coxa/geom/rigid_transform.h>

#include <nlohmann/json.hpp>

namespace coxa::serve {

/// Rows of the matrix, then the translation: 12 numbers.
nlohmann::json json_of(const RigidTransform& X);

}  // namespace coxa::serve
