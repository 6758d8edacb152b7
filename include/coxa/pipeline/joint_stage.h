#pragma once

#include <coxa/core/monitor.h>
#include <coxa/joint/simulate.h>
#include <coxa/motion/bone_frames.h>
#include <coxa/pipeline/stage.h>
#include <coxa/pipeline/subject.h>

#include <filesystem>
#include <optional>

namespace coxa::pipeline {

/// Everything the simulation of one hip reads: a joint file (`JOINT.toml`), paths resolved.
struct JointRequest {
  Side side = Side::right;
  std::filesystem::path acetabular_cartilage, femoral_cartilage;  ///< VTU with tagged facets
  std::filesystem::path hip_bone, femur;  ///< surfaces; both empty: no bony limit
  std::filesystem::path motion;           ///< folder of a motion stage
  JointEntry joint;
  std::optional<double> body_mass = std::nullopt;  ///< kg, for a load in percent of body weight
  std::filesystem::path labrum = {};       ///< surface; empty: contact with it is not looked for
  std::filesystem::path labrum_mesh = {};  ///< VTU of the soft labrum; empty: none bears
};

/// @throws Error bad_input for a missing or unknown key, a value out of range, or a file that does
/// not exist
JointRequest read_joint_request(const std::filesystem::path& path);
/// The request as TOML, paths relative to `folder`.
std::string to_toml(const JointRequest& request, const std::filesystem::path& folder);

/// The hip that a request names, read from its files.
joint::JointModel read_joint_model(const JointRequest& request, const motion::BoneFrames& frames);
/// The load it asks for.
joint::LoadCase joint_load(const JointRequest& request, const joint::JointModel& model);

/// What the joint stage computed, kept for pictures.
struct JointOutcome {
  joint::JointModel model;
  motion::HipMotion motion;
  joint::JointResult result;
};

/// Simulates the movement into `folder`: frames/*.vtu with results.pvd (ParaView), summary.csv,
/// joint.toml and the record joint.json. Frames that did not converge or lie beyond the bony limit
/// are named and carry no stress.
/// @throws Error no_convergence if no frame converged
Record run_joint_stage(const JointRequest& request, const std::filesystem::path& folder,
                       Reuse reuse, const Monitor& monitor);

}  // namespace coxa::pipeline
