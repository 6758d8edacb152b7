#include <coxa/pipeline/joint_stage.h>

#include <coxa/core/error.h>
#include <coxa/io/config.h>
#include <coxa/io/files.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/tets.h>
#include <coxa/pipeline/motion_stage.h>

#include "joint_figures.h"
#include "joint_files.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

// about what a joint centre from surfaces is uncertain by; half a millimetre would squeeze thin
// cartilage by a third, mm
constexpr double kCentreShift = 0.1;
constexpr double kTonnePerKilogram = 1e-3;

const char* name_of(Loading loading) {
  return loading == Loading::joint_force   ? "joint_force"
         : loading == Loading::body_weight ? "body_weight"
                                           : "prescribed_pose";
}

std::string numbers(const Vec3& v) { return join_text(v[0], ", ", v[1], ", ", v[2]); }

/// A ligament as the table of a joint file.
std::string to_toml(const LigamentEntry& l) {
  std::string text = join_text("\n[[joint.ligament]]\nname = \"", l.name, "\"\norigin_lps_mm = [",
                               numbers(l.origin), "]\ninsertion_lps_mm = [", numbers(l.insertion),
                               "]\nstiffness_N_per_mm = ", l.stiffness, "\n");
  if (l.slack_length) text += join_text("slack_length_mm = ", *l.slack_length, "\n");
  if (l.wrap_radius != 0.0) text += join_text("wrap_radius_mm = ", l.wrap_radius, "\n");
  return text;
}

Record wanted_record(const JointRequest& request) {
  Record record;
  record.verb = "joint";
  const JointEntry& j = request.joint;
  record.options = {{"side", std::string(request.side == Side::left ? "left" : "right")},
                    {"loading", std::string(name_of(j.loading))},
                    {"force_N", j.force},
                    {"young_mpa", j.youngs_modulus},
                    {"poisson", j.poisson_ratio},
                    {"law", j.law},
                    {"volume_change", j.volume_change}};
  if (j.loading == Loading::body_weight) {
    record.options["percent_body_weight"] = j.percent;
    record.options["body_mass_kg"] = *request.body_mass;
  }
  if (j.direction) {
    const Vec3& d = *j.direction;
    record.options["direction"] = join_text(d[0], " ", d[1], " ", d[2]);
  }
  // what is not asked for leaves no trace, so that results made before it could be are still valid
  if (j.friction > 0.0) record.options["friction"] = j.friction;
  if (j.bare_bone != "hip_bone") record.options["bare_bone"] = j.bare_bone;
  for (const LigamentEntry& ligament : j.ligaments)
    record.options["ligament " + ligament.name] = to_toml(ligament);
  record.inputs = {{"acetabular_cartilage", io::sha256_of_path(request.acetabular_cartilage)},
                   {"femoral_cartilage", io::sha256_of_path(request.femoral_cartilage)},
                   {"motion", io::sha256_of_path(request.motion / "motion.csv")},
                   {"frames", io::sha256_of_path(request.motion / "frames.json")}};
  if (!request.hip_bone.empty()) record.inputs["hip_bone"] = io::sha256_of_path(request.hip_bone);
  if (!request.femur.empty()) record.inputs["femur"] = io::sha256_of_path(request.femur);
  if (!request.labrum.empty()) record.inputs["labrum"] = io::sha256_of_path(request.labrum);
  if (!request.labrum_mesh.empty()) {
    record.inputs["labrum_mesh"] = io::sha256_of_path(request.labrum_mesh);
    record.options["labrum_young_mpa"] = j.labrum_modulus;
    record.options["labrum_poisson"] = j.labrum_poisson_ratio;
  }
  return record;
}

joint::JointOptions joint_options() {
  joint::JointOptions options;
  options.centre_shift = kCentreShift;
  return options;
}

fs::path existing(const io::Table& table, const std::string& key) {
  const auto path = table.find_path(key);
  require(path.has_value(), table.where(key), " is needed: the path of a file");
  require(fs::exists(*path), table.where(key), ": there is no ", path->string());
  return *path;
}

}  // namespace

joint::JointModel read_joint_model(const JointRequest& request, const motion::BoneFrames& frames) {
  joint::JointModel model;
  model.side = request.side;
  model.acetabular_cartilage = io::read_tets(request.acetabular_cartilage);
  model.femoral_cartilage = io::read_tets(request.femoral_cartilage);
  if (!request.hip_bone.empty()) model.hip_bone = io::read_surface(request.hip_bone);
  if (!request.femur.empty()) model.femur = io::read_surface(request.femur);
  if (!request.labrum.empty()) model.labrum = io::read_surface(request.labrum);
  if (!request.labrum_mesh.empty()) model.labrum_body = io::read_tets(request.labrum_mesh);
  model.labrum_material.youngs_modulus = request.joint.labrum_modulus;
  model.labrum_material.poissons_ratio = request.joint.labrum_poisson_ratio;
  model.X_IP = frames.pelvis.X_IB;
  model.X_IF = frames.femur.X_IB;
  model.material.law = request.joint.law == "corotational" ? joint::MaterialLaw::corotational
                       : request.joint.law == "neo_hookean"
                           ? joint::MaterialLaw::neo_hookean
                           : joint::MaterialLaw::st_venant_kirchhoff;
  model.material.youngs_modulus = request.joint.youngs_modulus;
  model.material.poissons_ratio = request.joint.poisson_ratio;
  model.material.volume_change = request.joint.volume_change == "patches"
                                     ? joint::VolumeChange::by_patches
                                     : joint::VolumeChange::by_elements;
  model.friction = request.joint.friction;
  model.bare_bone =
      request.joint.bare_bone == "both" ? joint::BareBone::both : joint::BareBone::hip_bone;
  for (const LigamentEntry& entry : request.joint.ligaments) {
    joint::Ligament ligament{entry.name,      entry.origin, entry.insertion,
                             entry.stiffness, 0.0,          entry.wrap_radius};
    ligament.slack_length =
        entry.slack_length.value_or(joint::image_length(ligament, model.X_IF.p));
    model.ligaments.push_back(ligament);
  }
  return model;
}

joint::LoadCase joint_load(const JointRequest& request, const joint::JointModel& model) {
  const JointEntry& j = request.joint;
  switch (j.loading) {
    case Loading::prescribed_pose:
      return joint::prescribed_pose();
    case Loading::body_weight:
      return joint::body_weight_load(j.percent, *request.body_mass * kTonnePerKilogram,
                                     j.direction.value_or(joint::into_socket(model)));
    case Loading::joint_force:
      break;
  }
  return j.direction ? joint::constant_force(j.force, *j.direction)
                     : joint::passive_examination(model, j.force);
}

JointRequest read_joint_request(const fs::path& path) {
  const io::Table root = io::Table::read(path);
  JointRequest request;
  request.side = read_side(root);
  request.acetabular_cartilage = existing(root, "acetabular_cartilage");
  request.femoral_cartilage = existing(root, "femoral_cartilage");
  if (root.has("hip_bone") || root.has("femur")) {
    request.hip_bone = existing(root, "hip_bone");
    request.femur = existing(root, "femur");
  }
  if (root.has("acetabular_labrum")) request.labrum = existing(root, "acetabular_labrum");
  if (root.has("acetabular_labrum_mesh"))
    request.labrum_mesh = existing(root, "acetabular_labrum_mesh");
  request.motion = existing(root, "motion");
  request.joint = read_joint_entry(root);
  request.body_mass = root.find<double>("body_mass_kg");
  require(request.joint.loading != Loading::body_weight || request.body_mass,
          root.where("body_mass_kg"), " is needed for a load in percent of body weight");
  root.finish();
  return request;
}

std::string to_toml(const JointRequest& request, const fs::path& folder) {
  const auto relative = [&](const fs::path& path) {
    return fs::relative(path, folder).generic_string();
  };
  const JointEntry& j = request.joint;
  std::string text =
      join_text("side = \"", request.side == Side::left ? "left" : "right", "\"\n",
                "acetabular_cartilage = \"", relative(request.acetabular_cartilage), "\"\n",
                "femoral_cartilage = \"", relative(request.femoral_cartilage), "\"\n");
  if (!request.hip_bone.empty()) {
    text += join_text("hip_bone = \"", relative(request.hip_bone), "\"\nfemur = \"",
                      relative(request.femur), "\"\n");
  }
  if (!request.labrum.empty())
    text += join_text("acetabular_labrum = \"", relative(request.labrum), "\"\n");
  if (!request.labrum_mesh.empty())
    text += join_text("acetabular_labrum_mesh = \"", relative(request.labrum_mesh), "\"\n");
  if (request.body_mass) text += join_text("body_mass_kg = ", *request.body_mass, "\n");
  text += join_text("motion = \"", relative(request.motion), "\"\n\n[joint]\nloading = \"",
                    name_of(j.loading), "\"\nforce_N = ", j.force,
                    "\nyoung_mpa = ", j.youngs_modulus, "\npoisson = ", j.poisson_ratio,
                    "\nlaw = \"", j.law, "\"\nvolume_change = \"", j.volume_change, "\"\n");
  if (j.loading == Loading::body_weight)
    text += join_text("percent_body_weight = ", j.percent, "\n");
  if (j.direction) {
    const Vec3& d = *j.direction;
    text += join_text("direction = [", d[0], ", ", d[1], ", ", d[2], "]\n");
  }
  if (!request.labrum_mesh.empty()) {
    text += join_text("labrum_young_mpa = ", j.labrum_modulus,
                      "\nlabrum_poisson = ", j.labrum_poisson_ratio, "\n");
  }
  if (j.friction > 0.0) text += join_text("friction = ", j.friction, "\n");
  if (j.bare_bone != "hip_bone") text += join_text("bare_bone = \"", j.bare_bone, "\"\n");
  for (const LigamentEntry& ligament : j.ligaments) text += to_toml(ligament);
  return text;
}

Record run_joint_stage(const JointRequest& request, const fs::path& folder, Reuse reuse,
                       const Monitor& monitor) {
  const auto body = [&](const fs::path& partial, Record& record) {
    const MotionArtefacts artefacts = read_motion_artefacts(request.motion, request.side);
    const joint::JointModel model = read_joint_model(request, artefacts.frames);
    const joint::JointResult result =
        joint::simulate(model, artefacts.motion, joint_load(request, model), joint_options(),
                        part_of(monitor, "joint", 0.0, 0.95));
    if (result.n_converged() == 0) {
      fail(ErrorCode::no_convergence,
           "no frame of the movement converged; frame 0: ", result.frames.front().reason);
    }
    add_joint_figures(result, record);
    write_frames(partial, model, artefacts.motion, result);
    io::write_bytes(partial / "summary.csv", summary_csv(artefacts.motion, result));
    io::write_bytes(partial / "joint.toml", to_toml(request, folder));
    for (const std::string& text : record.warnings) monitor.warn(text);
  };
  return run_stage(folder, wanted_record(request), reuse, monitor, body);
}

}  // namespace coxa::pipeline
