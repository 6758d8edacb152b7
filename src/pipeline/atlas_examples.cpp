#include <coxa/pipeline/atlas_examples.h>

#include <coxa/core/error.h>
#include <coxa/image/phantom.h>
#include <coxa/io/surfaces.h>
#include <coxa/motion/joint_centre.h>

#include <algorithm>
#include <set>

#include "label_map_bones.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

constexpr const char* kStructures[] = {"femur", "hip_bone", "femoral_cartilage",
                                       "acetabular_cartilage"};
// a scan's cut is flat: vertices this near to the lowest one of a femur are its cap, mm
constexpr double kCapHeight = 2.5;
// a femur that reaches less far below its head than this ends in a cut, not in a knee, mm
constexpr double kWholeFemur = 300.0;

/// A hip as it lies in its scan.
struct ScannedHip {
  std::string set, subject;  ///< "libhip", "m2"
  Side side = Side::right;
  SurfaceSet surfaces;
  std::map<std::string, VecX> trust;  ///< where not all is anatomy
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
  ScannedHip hip{set, subject, side, {}, {}};
  for (const char* structure : kStructures) {
    const fs::path path = folder / (std::string(structure) + ".ply");
    if (fs::exists(path)) hip.surfaces[structure].mesh = io::read_surface(path);
  }
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
      ScannedHip hip{"pelvic_ref", stem.substr(stem.find_last_of('_') + 1, 3), side, {}, {}};
      hip.surfaces["hip_bone"].mesh = bones.hip_bone;
      hip.surfaces["femur"].mesh = bones.femur;
      hip.trust["hip_bone"] = bones.hip_bone_trust;
      hips.push_back(std::move(hip));
    }
  }
  return hips;
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

void mirror(TriMesh& mesh) {
  mesh.points.col(0) *= -1.0;
  mesh.triangles.col(1).swap(mesh.triangles.col(2));
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
  const Vec3 centre = head_centre(hip);
  for (const auto& [structure, surface] : hip.surfaces) {
    shape::TrustedSurface trusted{surface.mesh, {}};
    trusted.mesh.points.rowwise() -= centre.transpose();
    if (hip.side == Side::left) mirror(trusted.mesh);
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

Contrast contrast_named(const std::string& name) {
  const std::map<std::string, Contrast> known{
      {"t1", Contrast::t1}, {"t2", Contrast::t2}, {"pd", Contrast::pd}, {"dess", Contrast::dess}};
  const auto it = known.find(name);
  require(it != known.end(), "no contrast \"", name, "\"; there are t1, t2, pd, dess");
  return it->second;
}

shape::ExampleImage simulated(const shape::HipExample& example, const std::string& contrast,
                              const AtlasExampleOptions& options, std::uint64_t seed,
                              const Monitor& monitor) {
  std::vector<TissueSurface> surfaces;
  for (const char* structure : kStructures) {
    const auto it = example.surfaces.find(structure);
    if (it == example.surfaces.end()) continue;
    const TriMesh& mesh = it->second.mesh;
    const bool bone = std::string(structure).find("cartilage") == std::string::npos;
    TissueSurface tissue{
        mesh.points, mesh.triangles, bone ? Tissue::marrow : Tissue::cartilage, {}};
    if (std::string(structure) == "femur")
      tissue.shell = shell_thicker_below(mesh.points, Vec3::Zero());
    if (std::string(structure) == "hip_bone") tissue.shell = VecX::Constant(mesh.n_vertices(), 1.0);
    surfaces.push_back(std::move(tissue));
  }
  PhantomOptions phantom;
  phantom.contrast = contrast_named(contrast);
  phantom.voxel = Vec3::Constant(options.voxel);
  phantom.centre = Vec3::Zero();
  phantom.field_of_view = Vec3(160.0, 160.0, 200.0);
  phantom.bias = 0.0;
  phantom.seed = seed;
  phantom.body_centre =
      Vec3(85.0, 20.0, 0.0);  // a right hip lies that far to the right of the body's axis
  return {contrast, simulate_mri(surfaces, phantom, monitor)};
}

/// MRI of an even choice of the examples with a femur or a hip bone.
void add_images(std::vector<shape::HipExample>& examples, const AtlasExampleOptions& options,
                const Monitor& monitor) {
  const auto n = static_cast<int>(examples.size());
  const int count = std::min(options.profile_hips, n);
  for (std::size_t c = 0; c < options.contrasts.size(); ++c) {
    for (int i = 0; i < count; ++i) {
      auto& example = examples[static_cast<std::size_t>(i * n / count)];
      const std::uint64_t seed = options.seed + 1000 * c + static_cast<std::uint64_t>(i);
      example.images.push_back(simulated(example, options.contrasts[c], options, seed, {}));
      monitor.check_cancelled();
      monitor.progress("simulated " + options.contrasts[c], (i + 1.0) / count);
    }
  }
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
  std::vector<ScannedHip> hips = scan_set(data / "libhip", "libhip");
  for (ScannedHip& hip : scan_set(data / "visible_human", "visible_human"))
    hips.push_back(std::move(hip));
  for (ScannedHip& hip : scan_label_maps(data / "labels" / "pelvic_ref"))
    hips.push_back(std::move(hip));
  if (hips.empty() && options.own.empty()) {
    fail(ErrorCode::bad_file, data.string(),
         " holds none of libhip, visible_human, labels/pelvic_ref");
  }
  for (const fs::path& folder : options.own) {
    const bool left = folder.filename().string().find("left") != std::string::npos;
    hips.push_back(
        read_hip("own", folder.filename().string(), folder, left ? Side::left : Side::right));
    require(!hips.back().surfaces.empty(), folder.string(), " holds no femur.ply, hip_bone.ply, …");
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
  add_images(examples, options, monitor);
  return examples;
}

}  // namespace coxa::pipeline
