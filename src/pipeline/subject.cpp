#include <coxa/pipeline/subject.h>

#include <coxa/core/error.h>
#include <coxa/io/config.h>
#include <coxa/pipeline/structures.h>
#include <coxa/shape/hip_structures.h>

#include <cstdlib>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

// a movement needs a start and an end; more than this is a mistake rather than a wish
constexpr Index kFewestFrames = 2, kMostFrames = 2000;
// joint forces beyond ten times a heavy body's weight are a wrong unit
constexpr double kLargestForce = 15000.0, kLargestPercent = 1500.0;

const std::map<std::string, Loading> kLoadings{{"joint_force", Loading::joint_force},
                                               {"body_weight", Loading::body_weight},
                                               {"prescribed_pose", Loading::prescribed_pose}};

fs::path existing(const io::Table& table, const std::string& key,
                  const std::optional<fs::path>& path) {
  require(path.has_value(), table.where(key), " is needed: the path of a file");
  require(fs::exists(*path), table.where(key), ": there is no ", path->string());
  return *path;
}

std::vector<ImageEntry> read_images(const io::Table& root) {
  std::vector<ImageEntry> images;
  for (const io::Table& table : root.tables("image")) {
    images.push_back(
        {existing(table, "path", table.find_path("path")), table.find<std::string>("series")});
    table.finish();
  }
  return images;
}

std::map<std::string, fs::path> read_surface_paths(const io::Table& root) {
  std::map<std::string, fs::path> surfaces;
  const auto table = root.find_table("surfaces");
  if (!table) return surfaces;
  for (const char* name : shape::kHipStructures)
    surfaces[name] = existing(*table, name, table->find_path(name));
  table->finish();
  return surfaces;
}

MotionEntry read_motion(const io::Table& root) {
  const auto table = root.find_table("motion");
  require(table.has_value(), root.where("motion"), " is needed: a table with a pattern or markers");
  MotionEntry motion;
  motion.pattern = table->value_or<std::string>("pattern", "");
  if (const auto file = table->find_path("pattern"); file && fs::is_regular_file(*file))
    motion.pattern = file->string();
  if (const auto markers = table->find_path("markers"))
    motion.markers = existing(*table, "markers", markers);
  if (const auto config = table->find_path("config"))
    motion.config = existing(*table, "config", config);
  if (const auto landmarks = table->find_path("landmarks"))
    motion.landmarks = existing(*table, "landmarks", landmarks);
  motion.frames = table->value_or<Index>("frames", motion.frames);
  motion.from = table->find<double>("from_s");
  motion.to = table->find<double>("to_s");
  table->finish();
  require(motion.pattern.empty() != motion.markers.empty(), root.where("motion"),
          " must give either a pattern or markers, and not both");
  require(motion.pattern.empty() || (!motion.from && !motion.to), table->where("from_s"),
          " and to_s choose a part of a recording; a pattern is simulated whole");
  require(!motion.from || !motion.to || *motion.from < *motion.to, table->where("to_s"),
          " must be later than from_s");
  require(kFewestFrames <= motion.frames && motion.frames <= kMostFrames, table->where("frames"),
          " must be ", kFewestFrames, " to ", kMostFrames, ", got ", motion.frames);
  return motion;
}

MeshEntry read_mesh(const io::Table& root) {
  MeshEntry mesh;
  const auto table = root.find_table("mesh");
  if (!table) return mesh;
  mesh.layers = table->value_or<Index>("layers", mesh.layers);
  mesh.max_tets = table->value_or<Index>("max_tets", mesh.max_tets);
  table->finish();
  require(1 <= mesh.layers && mesh.layers <= 8, table->where("layers"), " must be 1 to 8, got ",
          mesh.layers);
  require(mesh.max_tets >= 1000, table->where("max_tets"), " must be at least 1000, got ",
          mesh.max_tets);
  return mesh;
}

void check_joint(const io::Table& table, const JointEntry& joint) {
  require(joint.force > 0.0 && joint.force <= kLargestForce, table.where("force_N"),
          " must be in (0, ", kLargestForce, "] N, got ", joint.force);
  require((joint.percent > 0.0) == (joint.loading == Loading::body_weight) &&
              joint.percent <= kLargestPercent,
          table.where("percent_body_weight"), " must be in (0, ", kLargestPercent,
          "] with loading = \"body_weight\", and left out otherwise; got ", joint.percent);
  require(!joint.direction || joint.direction->norm() > 0.0, table.where("direction"),
          " must have a length");
  require(!joint.direction || joint.loading != Loading::prescribed_pose, table.where("direction"),
          " means nothing with a prescribed pose");
  require(joint.youngs_modulus > 0.0, table.where("young_mpa"), " must be positive, got ",
          joint.youngs_modulus);
  require(joint.poisson_ratio > 0.0 && joint.poisson_ratio < 0.5, table.where("poisson"),
          " must be in (0, 0.5), got ", joint.poisson_ratio);
  require(joint.law == "corotational" || joint.law == "st_venant_kirchhoff" ||
              joint.law == "neo_hookean",
          table.where("law"),
          " must be \"corotational\", \"st_venant_kirchhoff\" or \"neo_hookean\", got \"",
          joint.law, "\"");
  require(joint.labrum == "rigid" || joint.labrum == "soft", table.where("labrum"),
          " must be \"rigid\" or \"soft\", got \"", joint.labrum, "\"");
  require(joint.labrum_modulus > 0.0, table.where("labrum_young_mpa"), " must be positive, got ",
          joint.labrum_modulus);
  require(joint.labrum_poisson_ratio > 0.0 && joint.labrum_poisson_ratio < 0.5,
          table.where("labrum_poisson"), " must be in (0, 0.5), got ", joint.labrum_poisson_ratio);
  require(joint.volume_change == "patches" || joint.volume_change == "elements",
          table.where("volume_change"), " must be \"patches\" or \"elements\", got \"",
          joint.volume_change, "\"");
  require(joint.friction >= 0.0, table.where("friction"), " must not be negative, got ",
          joint.friction);
  require(joint.bare_bone == "hip_bone" || joint.bare_bone == "both", table.where("bare_bone"),
          " must be \"hip_bone\" or \"both\", got \"", joint.bare_bone, "\"");
}

std::vector<LigamentEntry> read_ligaments(const io::Table& joint) {
  std::vector<LigamentEntry> ligaments;
  for (const io::Table& table : joint.tables("ligament")) {
    ligaments.push_back({.name = table.get<std::string>("name"),
                         .origin = table.get<Vec3>("origin_lps_mm"),
                         .insertion = table.get<Vec3>("insertion_lps_mm"),
                         .stiffness = table.get<double>("stiffness_N_per_mm"),
                         .slack_length = table.find<double>("slack_length_mm"),
                         .wrap_radius = table.value_or("wrap_radius_mm", 0.0)});
    table.finish();
  }
  return ligaments;
}

/// Percent of body weight of an activity that was measured in vivo.
double measured_percent(const io::Table& table, const std::string& activity) {
  const io::Table loads = io::Table::read(shipped_data("in_vivo_loads.toml"));
  const auto load = loads.find_table(activity);
  std::string known;
  for (const std::string& name : loads.keys()) known += (known.empty() ? "" : ", ") + name;
  require(load.has_value(), table.where("activity"), ": there is no load of \"", activity,
          "\"; known are ", known);
  return load->get<double>("percent_body_weight");
}

}  // namespace

Side read_side(const io::Table& table) {
  const auto text = table.get<std::string>("side");
  require(text == "left" || text == "right", table.where("side"),
          " must be \"left\" or \"right\", got \"", text, "\"");
  return text == "left" ? Side::left : Side::right;
}

JointEntry read_joint_entry(const io::Table& root) {
  JointEntry joint;
  const auto table = root.find_table("joint");
  if (!table) return joint;
  const auto loading = table->value_or<std::string>("loading", "joint_force");
  require(kLoadings.count(loading), table->where("loading"), " must be \"joint_force\", ",
          "\"body_weight\" or \"prescribed_pose\", got \"", loading, "\"");
  joint.loading = kLoadings.at(loading);
  joint.force = table->value_or("force_N", joint.force);
  joint.percent = table->value_or("percent_body_weight", joint.percent);
  if (const auto activity = table->find<std::string>("activity")) {
    require(!table->has("percent_body_weight"), table->where("activity"),
            " and percent_body_weight exclude each other");
    joint.percent = measured_percent(*table, *activity);
  }
  joint.direction = table->find<Vec3>("direction");
  joint.youngs_modulus = table->value_or("young_mpa", joint.youngs_modulus);
  joint.poisson_ratio = table->value_or("poisson", joint.poisson_ratio);
  joint.law = table->value_or("law", joint.law);
  joint.volume_change = table->value_or("volume_change", joint.volume_change);
  joint.labrum = table->value_or("labrum", joint.labrum);
  joint.labrum_modulus = table->value_or("labrum_young_mpa", joint.labrum_modulus);
  joint.labrum_poisson_ratio = table->value_or("labrum_poisson", joint.labrum_poisson_ratio);
  joint.friction = table->value_or("friction", joint.friction);
  joint.bare_bone = table->value_or("bare_bone", joint.bare_bone);
  joint.ligaments = read_ligaments(*table);
  table->finish();
  check_joint(*table, joint);
  return joint;
}

Subject read_subject(const fs::path& path) {
  const io::Table root = io::Table::read(path);
  Subject subject;
  subject.file = path;
  subject.name = root.value_or<std::string>("name", path.stem().string());
  subject.side = read_side(root);
  subject.body_mass = root.find<double>("body_mass_kg");
  require(!subject.body_mass || *subject.body_mass > 0.0, root.where("body_mass_kg"),
          " must be positive");
  subject.images = read_images(root);
  subject.surfaces = read_surface_paths(root);
  require(subject.images.empty() != subject.surfaces.empty(), root.where("image"),
          " is needed: a table with the path of an MRI; or a table [surfaces] with the paths of ",
          "femur, hip_bone, femoral_cartilage and acetabular_cartilage, and not both");
  if (const auto table = root.find_table("landmarks")) {
    subject.landmarks = existing(*table, "path", table->find_path("path"));
    table->finish();
  }
  if (const auto table = root.find_table("pins")) {
    subject.pins = existing(*table, "path", table->find_path("path"));
    table->finish();
  }
  if (const auto table = root.find_table("labels")) {
    subject.labels = existing(*table, "path", table->find_path("path"));
    table->finish();
  }
  if (const auto list = root.find<std::string>("structures"))
    subject.structures = structures_from("bones,cartilage," + *list);
  subject.atlas = shipped_data("atlas/hip.coxa-atlas");
  if (const auto table = root.find_table("atlas")) {
    subject.atlas = existing(*table, "path", table->find_path("path"));
    table->finish();
  }
  subject.motion = read_motion(root);
  subject.mesh = read_mesh(root);
  subject.joint = read_joint_entry(root);
  require(subject.joint.loading != Loading::body_weight || subject.body_mass,
          root.where("body_mass_kg"), " is needed for a load in percent of body weight");
  root.finish();
  return subject;
}

fs::path shipped_data(const std::string& relative) {
  const char* override_folder = std::getenv("COXA_DATA");
  return fs::path(override_folder ? override_folder : COXA_DATA_DIR) / relative;
}

}  // namespace coxa::pipeline
