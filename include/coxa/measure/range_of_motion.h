#pragma once

#include <coxa/core/monitor.h>
#include <coxa/geom/rigid_transform.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/motion/hip_motion.h>

#include <optional>
#include <string>
#include <vector>

namespace coxa::measure {

/// One examination: the leg is brought to `from`, then turned towards `to`.
struct RomTest {
  std::string name;  ///< for example "fadir"
  motion::HipAngles from, to;
};

/// Flexion; internal rotation in 90 degrees of flexion; FADIR (90 flexion, 20 adduction, then
/// internal rotation); FABER (60 flexion, 40 abduction, then external rotation).
std::vector<RomTest> standard_rom_tests();

/// Bones of one hip for the search of their first contact; image frame, mm.
struct RomModel {
  Side side = Side::right;
  TriMesh hip_bone, femur;    ///< closed
  TriMesh femoral_cartilage;  ///< closed; the head under it and its fovea do not count
  Vec3 head_centre = Vec3::Zero();
  double head_radius = 0.0;   ///< > 0
  RigidTransform X_IP, X_IF;  ///< ISB frames of pelvis and femur, origins at the joint centre
};

struct RomOptions {
  double threshold = 0.0;      ///< mm, clearance that counts as contact
  double step = radians(1.0);  ///< rad, > 0, between poses that are tried; contact is bisected
};

struct RomResult {
  std::string name;
  double angle = 0.0;    ///< rad turned from `from` until contact, or all the way where none comes
  bool contact = false;  ///< on the way from `from` to `to`
  bool blocked = false;  ///< contact already on the way to `from`: `angle` is 0
  motion::HipAngles pose;             ///< at the contact, or `to`
  Vec3 place = Vec3::Constant(kNaN);  ///< of the contact on the hip bone, image frame
};

/// Range of motion until femur and hip bone first touch, with the joint centre held.
///
/// Bones only: capsule, labrum and muscles stop a living hip earlier.
/// @throws Error bad_input if an option is out of range or a surface has no triangle
/// Source: docs/measure.md section 5.
std::vector<RomResult> range_of_motion(const RomModel& model, const std::vector<RomTest>& tests,
                                       const RomOptions& options = {}, const Monitor& monitor = {});

/// Per femur vertex whether contact there counts: not within 2 mm of the cartilage, and not on the
/// head's sphere within 60 degrees of the cartilage's middle (the fovea).
std::vector<bool> counted_vertices(const RomModel& model);

}  // namespace coxa::measure
