#include <coxa/joint/load_case.h>

#include <coxa/core/error.h>

namespace coxa::joint {
namespace {

constexpr double kGravity = 9806.65;  // mm/s²

}  // namespace

Vec3 into_socket(const JointModel& model) {
  return -(model.X_IP.R.transpose() * socket_axis(model));
}

LoadCase constant_force(double newtons, const Vec3& direction_P) {
  require(newtons > 0.0, "joint force must be positive, got ", newtons, " N");
  require(direction_P.norm() > 0.0, "load direction has no length");
  const Vec3 unit = direction_P.normalized();
  LoadCase load;
  load.force_P = newtons * unit.transpose();
  load.description = join_text(newtons, " N along (", unit[0], ", ", unit[1], ", ", unit[2],
                               ") in pelvis axes (anterior, superior, right)");
  return load;
}

LoadCase passive_examination(const JointModel& model, double newtons) {
  LoadCase load = constant_force(newtons, into_socket(model));
  load.description =
      join_text(newtons, " N into the socket along its axis, as in a supine passive examination");
  return load;
}

LoadCase body_weight_load(double percent, double body_mass, const Vec3& direction_P) {
  require(percent > 0.0, "load must be a positive percentage of body weight, got ", percent);
  require(body_mass > 0.0, "body mass must be positive, got ", body_mass, " t");
  LoadCase load = constant_force(0.01 * percent * body_mass * kGravity, direction_P);
  load.description = join_text(percent, " % of body weight: ", load.description);
  return load;
}

LoadCase prescribed_pose() {
  LoadCase load;
  load.mode = LoadMode::prescribed_pose;
  load.description = "pose fully prescribed by the movement";
  return load;
}

}  // namespace coxa::joint
