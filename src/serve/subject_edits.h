#pragma once

#include <coxa/core/monitor.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "case_folder.h"

namespace coxa::serve {

/// {"version", "landmarks": [{"name", "position_lps_mm"}], "known": names}; version is "" where
/// there are none yet.
nlohmann::json stored_landmarks(const CaseFolder& folder);
/// Writes landmarks.mrk.json of {"version", "landmarks"}; version must be the one last read.
/// @returns what is stored now; nullopt if it was changed meanwhile
/// @throws Error bad_input for a name that is no word or comes twice, or a place that is no point
std::optional<nlohmann::json> store_landmarks(const CaseFolder& folder,
                                              const nlohmann::json& wanted);

/// The same for the points that surfaces must pass through, pins.mrk.json; "known" are the
/// structures, and a name is a structure's with a dash and a number. An empty list removes the
/// file.
nlohmann::json stored_pins(const CaseFolder& folder);
std::optional<nlohmann::json> store_pins(const CaseFolder& folder, const nlohmann::json& wanted);

/// Writes movements/<name>.toml of {"name", "time_s", "flexion_deg", "adduction_deg",
/// "internal_rotation_deg"}, in the form of data/movements.
/// @returns {"file": path in the folder}
nlohmann::json store_movement(const CaseFolder& folder, const nlohmann::json& wanted);

/// What the job {"job": "segment", "side"} or {"job": "run"} does; landmarks and pins
/// are the folder's.
/// @throws Error bad_input if it cannot be done on this folder
std::function<void(const Monitor&)> job_body(
    const CaseFolder& folder, const nlohmann::json& job,
    const std::function<void(const SurfaceSet&)>& on_found);

}  // namespace coxa::serve
