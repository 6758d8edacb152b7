#pragma once

#include <coxa/pipeline/record.h>

#include <map>
#include <string>

namespace coxa::pipeline {

/// What coxa does where nothing is said: by section, then key with its unit. The sections `motion`,
/// `mesh` and `joint` are those of the subject file; the others are verbs.
std::map<std::string, Fields> default_options();

/// As TOML: a table for every section.
std::string to_toml(const std::map<std::string, Fields>& sections);

}  // namespace coxa::pipeline
