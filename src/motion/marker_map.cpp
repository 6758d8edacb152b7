#include <coxa/motion/marker_map.h>

#include <algorithm>
#include <cctype>

namespace coxa::motion {
namespace {

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }
bool digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// every label with @ replaced by the side's letter
std::vector<std::string> for_side(std::vector<std::string> labels, Side side) {
  for (std::string& label : labels)
    std::replace(label.begin(), label.end(), '@', side == Side::right ? 'R' : 'L');
  return labels;
}

std::vector<std::string> asis(Side side) {
  return for_side({"@ASI", "@ASIS", "@.ASIS", "@_ASIS", "@ asis", "@IAS"}, side);
}
std::vector<std::string> psis(Side side) {
  return for_side({"@PSI", "@PSIS", "@.PSIS", "@_PSIS", "@ psis", "@IPS"}, side);
}

}  // namespace

std::string_view name(MarkerRole role) {
  switch (role) {
    case MarkerRole::asis_left:
      return "asis_left";
    case MarkerRole::asis_right:
      return "asis_right";
    case MarkerRole::psis_left:
      return "psis_left";
    case MarkerRole::psis_right:
      return "psis_right";
    case MarkerRole::sacrum:
      return "sacrum";
    case MarkerRole::knee_lateral:
      return "knee_lateral";
    case MarkerRole::knee_medial:
      return "knee_medial";
    case MarkerRole::thigh:
      return "thigh";
  }
  return "unknown";
}

MarkerMap default_marker_map(Side side) {
  return {
      {MarkerRole::asis_left, asis(Side::left)},
      {MarkerRole::asis_right, asis(Side::right)},
      {MarkerRole::psis_left, psis(Side::left)},
      {MarkerRole::psis_right, psis(Side::right)},
      {MarkerRole::sacrum, {"SACR", "sacrum", "V.Sacral", "SACRUM"}},
      {MarkerRole::knee_lateral,
       for_side({"@KNE", "@LKNE", "@FLE", "@LE", "@_knee", "@KNEE", "@ knee 1", "@KNE1"}, side)},
      {MarkerRole::knee_medial, for_side({"@KNM", "@KNEM", "@MKNE", "@KNEin", "@KNE_md", "@FME",
                                          "@ME", "@_mknee", "@ knee 2", "@KNE2"},
                                         side)},
      {MarkerRole::thigh,
       for_side({"@THI", "@THI#", "@TH#", "@THAP", "@THAD", "@THLP", "@THLD", "@F#", "@_thigh#",
                 "@ thigh", "@ bar 1", "@BAR1", "@.Thigh.#", "@GTR"},
                side)}};
}

bool label_matches(const std::string& label, const std::string& pattern) {
  std::size_t at = 0;
  for (const char c : pattern) {
    if (c == '#') {
      const std::size_t begin = at;
      while (at < label.size() && digit(label[at])) ++at;
      if (at == begin) return false;
    } else {
      if (at == label.size() || lower(label[at]) != lower(c)) return false;
      ++at;
    }
  }
  return at == label.size();
}

MarkerRoles find_roles(const MarkerData& markers, const MarkerMap& map) {
  MarkerRoles roles;
  for (const auto& [role, patterns] : map) {
    std::vector<std::string> found;
    for (const std::string& pattern : patterns) {
      for (const std::string& label : markers.labels) {
        const bool again = std::find(found.begin(), found.end(), label) != found.end();
        if (!again && label_matches(label, pattern)) found.push_back(label);
      }
      if (role != MarkerRole::thigh && !found.empty()) break;
    }
    if (found.empty()) continue;
    if (role != MarkerRole::thigh) found.resize(1);
    roles[role] = found;
  }
  return roles;
}

}  // namespace coxa::motion
