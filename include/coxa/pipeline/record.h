#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace coxa::pipeline {

using Value = std::variant<bool, std::int64_t, double, std::string>;
using Fields = std::map<std::string, Value>;  ///< key with its unit, for example "target_edge_mm"

/// What a verb did: written as JSON beside its result, and the ground on which a finished stage is
/// kept.
struct Record {
  std::string verb;
  Fields options;                             ///< in full, defaults included
  std::map<std::string, std::string> inputs;  ///< role -> SHA-256 of the content
  Fields figures;                             ///< results a reader would quote, unit in the key
  std::vector<std::string> warnings;
  double seconds = 0.0;
  double peak_memory_mb = 0.0;  ///< of the process, up to the end of the verb
};

/// SHA-256 over version, verb, options and inputs: equal keys mean an equal result.
std::string record_key(const Record& record);

/// The record as JSON text, with coxa's version and the key.
std::string to_json(const Record& record);

/// @throws Error bad_file if it cannot be written; nothing half-written is left
void write_record(const std::filesystem::path& path, const Record& record);

/// @throws Error bad_file if it is missing or not a record
Record read_record(const std::filesystem::path& path);

/// Largest resident memory of this process so far, MB.
double peak_memory_mb();

/// coxa's version, for example "0.1.0".
std::string version();

}  // namespace coxa::pipeline
