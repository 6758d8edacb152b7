#include <coxa/joint/load_case.h>

#include <coxa/core/error.h>

namespace coxa::joint {
namespace {

constexpr double kGravity = 9806.65;  // mm/s²

}  // namespace

LoadCase passive_examination(const JointModel& model, double newtons) {
  require(newtons > 0.0, "joint force must be positive, got ", newtons, " N");
  LoadCase load;
  load.force_P = -newtons * (model.X_IP.R.transpose() * socket_axis(model)).transpose();
  load.description =
      join_text(newtons, " N into the socket along its axis, as in a supine passive examination");
  return load;
}

LoadCase body_weight_load(double percent, double body_mass, const Vec3& direction_P) {
  require(percent > 0.0, "load must be a positive percentage of body weight, got ", percent);
  require(body_mass > 0.0, "body mass must be positive, got ", body_mass, " t");
  require(direction_P.norm() > 0.0, "load direction has no length");
  const double newtons = 0.01 * percent * body_mass * kGravity;
  LoadCase load;
  load.force_P = newtons * direction_P.normalized().transpose();
  load.description = join_text(newtons, " N, ", percent, " % of body weight");
  return load;
}

LoadCase prescribed_pose() {
  LoadCase load;
  load.mode = LoadMode::prescribed_pose;
  load.description = "pose fully prescribed by the movement";
  return load;
}

}  // namespace coxa::joint
