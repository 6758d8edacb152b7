#include <coxa/pipeline/atlas_examples.h>

#include <coxa/core/error.h>
#include <coxa/io/surfaces.h>
#include <coxa/mesh/mirrored.h>
#include <coxa/motion/joint_centre.h>
#include <coxa/shape/hip_structures.h>

#include <algorithm>
#include <set>

#include "label_map_bones.h"
#include "muscle_examples.h"
#include "own_labels.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

// a scan's cut is flat: vertices this near to the lowest one of a femur are its cap, mm
constexpr double kCapHeight = 2.5;
// a femur that reaches less far below its head than this ends in a cut, not in a knee, mm
constexpr double kWholeFemur = 300.0;

// the thickness of this set's cartilages differs oddly between the sides of a body
constexpr const char* kOddCartilages = "visible_human";

/// A hip as it lies in its scan.
struct ScannedHip {
  std::string set, subject;  ///< "libhip", "m2"
  Side side = Side::right;
  SurfaceSet surfaces;
  std::map<std::string, VecX> trust;  ///< where not all is anatomy
  std::map<std::string, Index> bone_side_faces;
  std::string name() const {
    return set + "/" + subject + "/" + (side == Side::left ? "left" : "right");
  }
};

std::vector<fs::path> subfolders(const fs::path& folder) {
  std::vector<fs::path> found;
  if (!fs::is_directory(folder)) return found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory()) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

ScannedHip read_hip(const std::string& set, const std::string& subject, const fs::path& folder,
                    Side side) {
  ScannedHip hip{set, subject, side, {}, {}, {}};
  for (const char* structure : shape::kHipStructures) {
    const fs::path path = folder / (std::string(structure) + ".ply");
    const bool cartilage = std::string(structure).find("_cartilage") != std::string::npos;
    if (!fs::exists(path) || (cartilage && set == kOddCartilages)) continue;
    hip.surfaces[structure].mesh = io::read_surface(path);
    if (const auto n = io::read_bone_side_faces(path)) hip.bone_side_faces[structure] = *n;
  }
  hip.surfaces.merge(read_muscles(folder));
  return hip;
}

std::vector<ScannedHip> scan_set(const fs::path& folder, const std::string& set) {
  std::vector<ScannedHip> hips;
  for (const fs::path& subject : subfolders(folder)) {
    for (const auto& [word, side] : {std::pair{"left", Side::left}, {"right", Side::right}}) {
      if (!fs::is_directory(subject / word)) continue;
      ScannedHip hip = read_hip(set, subject.filename().string(), subject / word, side);
      if (!hip.surfaces.empty()) hips.push_back(std::move(hip));
    }
  }
  return hips;
}

/// Both hips of every label map.
std::vector<ScannedHip> scan_label_maps(const fs::path& folder) {
  std::vector<ScannedHip> hips;
  std::vector<fs::path> files;
  if (fs::is_directory(folder)) {
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    for (const Side side : {Side::left, Side::right}) {
      const LabelledBones bones = bones_from_labels(file, side);
      const std::string stem = file.filename().string();
      ScannedHip hip{"pelvic_ref", stem.substr(stem.find_last_of('_') + 1, 3), side, {}, {}, {}};
      hip.surfaces["hip_bone"].mesh = bones.hip_bone;
      hip.surfaces["femur"].mesh = bones.femur;
      hip.trust["hip_bone"] = bones.hip_bone_trust;
      for (auto& [muscle, surface] : muscles_from_labels(file, side)) {
        hip.surfaces[muscle].mesh = std::move(surface.mesh);
        if (surface.trust.size() > 0) hip.trust[muscle] = std::move(surface.trust);
      }
      hips.push_back(std::move(hip));
    }
  }
  return hips;
}

/// A hip that a user segmented: a folder of surfaces, or a label map in a folder of its own.
ScannedHip read_own(const fs::path& path) {
  const bool map = !fs::is_directory(path);
  const fs::path folder = map ? fs::absolute(path).parent_path() : path;
  const std::string name = folder.filename().string();
  const auto is = [&](const char* side) {
    return (name + path.filename().string()).find(side) != std::string::npos;
  };
  require(is("left") != is("right"), "which side is ", path.string(),
          "? Its name or its folder's must have \"left\" or \"right\" in it");
  const Side side = is("left") ? Side::left : Side::right;
  if (!map) {
    ScannedHip hip = read_hip("own", name, folder, side);
    require(!hip.surfaces.empty(), folder.string(), " holds no femur.ply, hip_bone.ply, …");
    return hip;
  }
  OwnLabels own = read_own_labels(path);
  return {"own", name, side, std::move(own.surfaces), std::move(own.trust), {}};
}

bool excluded(const ScannedHip& hip, const AtlasExampleOptions& options) {
  return std::find(options.exclude.begin(), options.exclude.end(), hip.subject) !=
         options.exclude.end();
}

void drop_structures(ScannedHip& hip, const AtlasExampleOptions& options) {
  for (const std::string& pattern : options.exclude_structures) {
    const auto colon = pattern.find(':');
    require(colon != std::string::npos, "excluded structures are written set:structure, got \"",
            pattern, "\"");
    if (pattern.substr(0, colon) == hip.set) hip.surfaces.erase(pattern.substr(colon + 1));
  }
}

VecX cap_trust(const TriMesh& femur) {
  const double lowest = femur.points.col(2).minCoeff();
  if (lowest < -kWholeFemur) return {};
  return (femur.points.col(2).array() > lowest + kCapHeight).cast<double>();
}

Vec3 head_centre(const ScannedHip& hip) {
  motion::JointCentreOptions options;
  options.congruency_samples = 0;
  return motion::find_joint_centre(hip.surfaces, options).chosen.centre;
}

/// As a right hip with the head's centre at the origin.
shape::HipExample as_example(const ScannedHip& hip) {
  shape::HipExample example;
  example.name = hip.name();
  example.bone_side_faces = hip.bone_side_faces;
  const Vec3 centre = head_centre(hip);
  for (const auto& [structure, surface] : hip.surfaces) {
    shape::TrustedSurface trusted{surface.mesh, {}};
    trusted.mesh.points.rowwise() -= centre.transpose();
    if (hip.side == Side::left) trusted.mesh = mirrored(std::move(trusted.mesh));
    const auto trust = hip.trust.find(structure);
    if (trust != hip.trust.end()) trusted.trust = trust->second;
    if (structure == "femur") trusted.trust = cap_trust(trusted.mesh);
    example.surfaces[structure] = std::move(trusted);
  }
  return example;
}

/// Fullest and longest first: the first example gives the template.
void sort_by_use(std::vector<shape::HipExample>& examples) {
  const auto femur_reach = [](const shape::HipExample& e) {
    const auto it = e.surfaces.find("femur");
    const double reach = it == e.surfaces.end() ? 0.0 : -it->second.mesh.points.col(2).minCoeff();
    return reach > kWholeFemur ? 0.0 : reach;  // a whole femur is more than a hip MRI shows
  };
  std::stable_sort(examples.begin(), examples.end(),
                   [&](const auto& a, const auto& b) { return femur_reach(a) > femur_reach(b); });
}

void check_exclusions(const std::vector<ScannedHip>& hips, const AtlasExampleOptions& options) {
  std::set<std::string> subjects;
  for (const ScannedHip& hip : hips) subjects.insert(hip.subject);
  for (const std::string& name : options.exclude) {
    std::string known;
    for (const std::string& subject : subjects) known += (known.empty() ? "" : ", ") + subject;
    require(subjects.count(name) > 0, "there is no subject \"", name, "\" to exclude; there are ",
            known);
  }
}

}  // namespace

std::vector<shape::HipExample> load_atlas_examples(const fs::path& data,
                                                   const AtlasExampleOptions& options,
                                                   const Monitor& monitor) {
  monitor.progress("examples", 0.0);
  monitor.check_cancelled();
  std::vector<ScannedHip> hips = scan_set(data / "libhip", "libhip");
  for (ScannedHip& hip : scan_set(data / "visible_human", "visible_human"))
    hips.push_back(std::move(hip));
  monitor.check_cancelled();
  for (ScannedHip& hip : scan_label_maps(data / "labels" / "pelvic_ref"))
    hips.push_back(std::move(hip));
  if (hips.empty() && options.own.empty()) {
    fail(ErrorCode::bad_file, data.string(),
         " holds none of libhip, visible_human, labels/pelvic_ref");
  }
  for (const fs::path& path : options.own) {
    hips.push_back(read_own(path));
    monitor.check_cancelled();
  }
  check_exclusions(hips, options);
  std::vector<shape::HipExample> examples;
  for (ScannedHip& hip : hips) {
    if (excluded(hip, options)) continue;
    drop_structures(hip, options);
    if (!hip.surfaces.empty()) examples.push_back(as_example(hip));
    monitor.check_cancelled();
  }
  sort_by_use(examples);
  return examples;
}

}  // namespace coxa::pipeline
