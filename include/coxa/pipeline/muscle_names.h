#pragma once

#include <string>
#include <vector>

namespace coxa::pipeline {

/// Every muscle of hip and thigh that the atlas is built with, by its name.
const std::vector<std::string>& muscle_names();

}  // namespace coxa::pipeline
