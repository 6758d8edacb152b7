#include <coxa/pipeline/structures.h>

#include <coxa/pipeline/muscle_names.h>
#include <coxa/shape/ligaments.h>

#include <algorithm>
#include <map>
#include <sstream>

namespace coxa::pipeline {
namespace {

using Names = std::vector<std::string>;

std::map<std::string, Names> groups() {
  Names ligaments(generic_names().begin() + 1, generic_names().end()), all;
  std::map<std::string, Names> groups{{"bones", {"femur", "hip_bone"}},
                                      {"cartilage", {"femoral_cartilage", "acetabular_cartilage"}},
                                      {"muscles", muscle_names()},
                                      {"labrum", {"acetabular_labrum"}},
                                      {"ligaments", ligaments}};
  for (const char* group : {"bones", "cartilage", "muscles", "labrum", "ligaments"})
    all.insert(all.end(), groups[group].begin(), groups[group].end());
  groups["all"] = all;
  groups["iliofemoral_ligament"] = {"iliofemoral_ligament_transverse",
                                    "iliofemoral_ligament_descending"};
  return groups;
}

}  // namespace

const Names& generic_names() {
  static const Names names = [] {
    Names all{"acetabular_labrum", "transverse_acetabular_ligament"};
    const Names& ligaments = shape::generic_ligament_names();
    all.insert(all.end(), ligaments.begin(), ligaments.end());
    return all;
  }();
  return names;
}

bool is_generic(const std::string& structure) {
  const Names& names = generic_names();
  return std::find(names.begin(), names.end(), structure) != names.end();
}

Names structures_from(const std::string& list) {
  const auto known = groups();
  Names names;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    const auto group = known.find(word);
    const Names named = group == known.end() ? Names{word} : group->second;
    for (const std::string& name : named) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

}  // namespace coxa::pipeline
