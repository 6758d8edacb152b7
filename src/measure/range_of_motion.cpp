#include <coxa/measure/range_of_motion.h>

#include <coxa/collide/rigid_pair.h>
#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>

#include <algorithm>
#include <cmath>

namespace coxa::measure {
namespace {

constexpr double kCoverReach = 2.0;            // mm from the cartilage: covered bone
constexpr double kFoveaAngle = radians(60.0);  // from the cartilage's middle
constexpr double kFoveaHeight = 1.5;           // mm outside the head's sphere at most

motion::HipAngles between(const motion::HipAngles& a, const motion::HipAngles& b, double share) {
  return {a.flexion + share * (b.flexion - a.flexion),
          a.adduction + share * (b.adduction - a.adduction),
          a.internal_rotation + share * (b.internal_rotation - a.internal_rotation)};
}

double largest_difference(const motion::HipAngles& a, const motion::HipAngles& b) {
  return std::max({std::abs(a.flexion - b.flexion), std::abs(a.adduction - b.adduction),
                   std::abs(a.internal_rotation - b.internal_rotation)});
}

/// Where on the straight way between two poses the bones first touch; the share of the way.
std::optional<collide::FirstContact> contact_between(const collide::RigidPair& pair,
                                                     const RomModel& model,
                                                     const motion::HipAngles& from,
                                                     const motion::HipAngles& to,
                                                     const RomOptions& options) {
  const auto steps = std::max<Index>(
      1, static_cast<Index>(std::ceil(largest_difference(from, to) / options.step)));
  const auto pose_at = [&](double parameter) {
    const RigidTransform X_PF{
        motion::rotation_from_angles(between(from, to, parameter / steps), model.side),
        Vec3::Zero()};
    return model.X_IP * X_PF * model.X_IF.inverse();
  };
  auto contact = collide::first_contact(pair, pose_at, steps, options.threshold);
  if (contact) contact->parameter /= steps;
  return contact;
}

RomResult examine(const collide::RigidPair& pair, const RomModel& model, const RomTest& test,
                  const RomOptions& options) {
  RomResult result{.name = test.name, .pose = test.to};
  if (const auto early = contact_between(pair, model, {}, test.from, options)) {
    result.blocked = true;
    result.pose = between({}, test.from, early->parameter);
    result.place = early->clearance.fixed_point;
    return result;
  }
  result.angle = largest_difference(test.from, test.to);
  if (const auto contact = contact_between(pair, model, test.from, test.to, options)) {
    result.contact = true;
    result.angle *= contact->parameter;
    result.pose = between(test.from, test.to, contact->parameter);
    result.place = contact->clearance.fixed_point;
  }
  return result;
}

}  // namespace

std::vector<RomTest> standard_rom_tests() {
  constexpr double kRight = radians(90.0);
  return {
      {"flexion", {}, {radians(150.0), 0.0, 0.0}},
      {"internal_rotation_at_90_flexion", {kRight, 0.0, 0.0}, {kRight, 0.0, kRight}},
      {"fadir", {kRight, radians(20.0), 0.0}, {kRight, radians(20.0), kRight}},
      {"faber", {radians(60.0), radians(-40.0), 0.0}, {radians(60.0), radians(-40.0), -kRight}}};
}

std::vector<bool> counted_vertices(const RomModel& model) {
  const TriangleTree covered(model.femoral_cartilage.points, model.femoral_cartilage.triangles);
  const Vec3 middle =
      (model.femoral_cartilage.points.rowwise() - model.head_centre.transpose()).colwise().mean();
  std::vector<char> counts(static_cast<std::size_t>(model.femur.n_vertices()));
  parallel_for(model.femur.n_vertices(), [&](Index v) {
    const Vec3 p = model.femur.points.row(v), arm = p - model.head_centre;
    const bool fovea = arm.norm() < model.head_radius + kFoveaHeight &&
                       arm.normalized().dot(middle.normalized()) > std::cos(kFoveaAngle);
    counts[static_cast<std::size_t>(v)] = !fovea && !covered.nearest_within(p, kCoverReach);
  });
  return {counts.begin(), counts.end()};
}

std::vector<RomResult> range_of_motion(const RomModel& model, const std::vector<RomTest>& tests,
                                       const RomOptions& options, const Monitor& monitor) {
  require(options.step > 0.0, "step must be positive, got ", options.step, " rad");
  require(model.head_radius > 0.0, "the head's radius must be positive, got ", model.head_radius);
  for (const TriMesh* mesh : {&model.hip_bone, &model.femur, &model.femoral_cartilage})
    require(!mesh->empty(), "range of motion needs hip bone, femur and femoral cartilage");
  const collide::RigidPair pair(model.hip_bone, model.femur, counted_vertices(model));
  std::vector<RomResult> results;
  for (const RomTest& test : tests) {
    monitor.check_cancelled();
    monitor.progress("rom",
                     static_cast<double>(results.size()) / static_cast<double>(tests.size()));
    results.push_back(examine(pair, model, test, options));
  }
  return results;
}

}  // namespace coxa::measure
