#include "predictor.h"

#include <coxa/geom/fits.h>

#include <algorithm>

namespace coxa::joint {
namespace {

// mm of a node's way for a radian of turn: about the head's radius
constexpr double kArm = 25.0;
// cosine between two steps below which the second is no continuation of the first
constexpr double kSameWay = 0.9;
// a step is predicted from one no shorter than half of it
constexpr double kLongest = 2.0;

Eigen::Matrix<double, 6, 1> way(const BonePose& from, const BonePose& to) {
  Eigen::Matrix<double, 6, 1> way;
  way << kArm * rotation_vector(to.R * from.R.transpose()), to.shift - from.shift;
  return way;
}

}  // namespace

void Predictor::carry(const HipSystem& system, HipState& state, const BonePose& target) const {
  const BonePose from = state.pose;
  state.pose = target;
  if (!has_rate()) return system.update_pose(state.x, from, target);
  const auto last = way(from_, from), next = way(from, target);
  system.update_pose(state.x, from, target);
  if (!(last.dot(next) > kSameWay * last.norm() * next.norm())) return;
  const double share = next.norm() / last.norm();
  if (share > kLongest) return;
  // where the step before started, carried to the same pose
  VecX earlier = x_;
  system.update_pose(earlier, from_, target);
  state.x += share * (state.x - earlier);
}

void Predictor::note(const HipState& before) {
  x_ = before.x;
  from_ = before.pose;
}

}  // namespace coxa::joint
