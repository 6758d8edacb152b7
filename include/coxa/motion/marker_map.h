#pragma once

#include <coxa/motion/marker_data.h>

#include <map>
#include <string>
#include <vector>

namespace coxa::motion {

/// What a marker is for. Left and right are told apart by the map, not here.
enum class MarkerRole {
  asis_left,
  asis_right,
  psis_left,
  psis_right,
  sacrum,
  knee_lateral,
  knee_medial,
  thigh
};
inline constexpr MarkerRole kAllMarkerRoles[] = {MarkerRole::asis_left,   MarkerRole::asis_right,
                                                 MarkerRole::psis_left,   MarkerRole::psis_right,
                                                 MarkerRole::sacrum,      MarkerRole::knee_lateral,
                                                 MarkerRole::knee_medial, MarkerRole::thigh};
/// For example "asis_left".
std::string_view name(MarkerRole role);

/// Labels that a laboratory may use for each role, in order of preference. In a label `#` stands
/// for one or more digits. All roles but `thigh` take the first label that is in the recording;
/// `thigh` takes all of them.
using MarkerMap = std::map<MarkerRole, std::vector<std::string>>;

/// Labels of the common sets for one side: conventional gait model and Plug-in Gait (LASI, RTHI,
/// RKNE, SACR, …), CGM2, Calibrated Anatomical System Technique and ISB names, OpenSim's examples.
MarkerMap default_marker_map(Side side);

/// Labels of the recording by role; roles without any are absent. Case is ignored.
using MarkerRoles = std::map<MarkerRole, std::vector<std::string>>;
MarkerRoles find_roles(const MarkerData& markers, const MarkerMap& map);

/// True when `label` is what `pattern` (with # for digits) describes, ignoring case.
bool label_matches(const std::string& label, const std::string& pattern);

}  // namespace coxa::motion
