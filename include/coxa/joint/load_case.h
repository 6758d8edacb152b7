#pragma once

#include <coxa/joint/joint_model.h>

#include <string>

namespace coxa::joint {

/// What moves the femur beside its rotation.
enum class LoadMode {
  force,           ///< translation found so that contact balances the joint force
  prescribed_pose  ///< translation as the movement has it (the paper)
};

struct LoadCase {
  LoadMode mode = LoadMode::force;
  Points force_P;  ///< 1×3 for all frames, or frames×3: force of the femur on the socket, N, pelvis
                   ///< axes
  std::string description;  ///< for the report
};

/// Supine passive examination: a constant force into the socket along its axis reversed.
/// @param newtons > 0
LoadCase passive_examination(const JointModel& model, double newtons = 500.0);

/// A constant force along `direction_P` (pelvis axes, femur onto socket, any length).
/// @param newtons > 0
LoadCase constant_force(double newtons, const Vec3& direction_P);

/// Direction of the passive examination's force in pelvis axes, unit.
Vec3 into_socket(const JointModel& model);

/// A force of `percent` of body weight along `direction_P` (pelvis axes, femur onto socket, any
/// length).
/// @param body_mass tonne, > 0   @param percent > 0
LoadCase body_weight_load(double percent, double body_mass, const Vec3& direction_P);

/// The pose fully prescribed by the movement.
LoadCase prescribed_pose();

}  // namespace coxa::joint
