#pragma once

#include <string>
#include <vector>

namespace coxa::pipeline {

/// Labrum and ligaments: models made from published anatomy, which no image shows and no example
/// taught.
const std::vector<std::string>& generic_names();
bool is_generic(const std::string& structure);

/// The structures that a list names: groups (bones, cartilage, muscles, labrum, ligaments, all;
/// iliofemoral_ligament for its two bands) or single names, separated by commas.
std::vector<std::string> structures_from(const std::string& list);

}  // namespace coxa::pipeline
