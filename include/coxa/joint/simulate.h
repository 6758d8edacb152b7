#pragma once

#include <coxa/core/monitor.h>
#include <coxa/joint/joint_model.h>
#include <coxa/joint/joint_result.h>
#include <coxa/joint/load_case.h>
#include <coxa/motion/hip_motion.h>

#include <optional>

namespace coxa::joint {

struct JointOptions {
  double contact_stiffness = 100.0;     ///< MPa/mm, > 0: penalty; multipliers remove what it leaves
  double penetration_tolerance = 0.01;  ///< mm, > 0: largest overlap of a converged frame
  double residual_tolerance = 2e-4;  ///< of the nodal forces' norm relative to the joint force, > 0
  double max_rotation_step = radians(3.0);  ///< rad, > 0: larger movements are cut into sub-steps
  double max_translation_step = 0.25;       ///< mm, > 0, likewise of a prescribed translation
  int max_newton_iterations = 30;           ///< > 0 for one frozen set of contact pairs
  int max_contact_updates = 80;  ///< > 0 rounds of contact search and multipliers a sub-step
  int max_cutbacks = 3;          ///< >= 0: a failing sub-step is halved so many times
  double max_translation = 5.0;  ///< mm, > 0: a head that goes farther has left the socket
  std::optional<double> centre_shift =
      0.5;  ///< mm, > 0: for the sensitivity at the last frame; nullopt: none
};

/// Stress in the hip's cartilage over a movement, quasi-static, frame by frame.
///
/// The acetabular cartilage's bone side is held, the femoral one moves with the femur: rotation
/// from the motion about the joint centre, translation from force balance (or prescribed).
/// Contact between the articular sides, with the model's friction. Starts from the image pose, in
/// gap or overlap, and follows the movement in sub-steps.
///
/// @throws Error bad_input, bad_mesh (model, load, motion, options); cancelled
/// @note   a frame that does not converge is returned as failed with the reason; bit-identical for
/// any number of
///         threads
/// Source: docs/joint.md.
JointResult simulate(const JointModel& model, const motion::HipMotion& motion, const LoadCase& load,
                     const JointOptions& options = {}, const Monitor& monitor = {});

/// Strain and stress of the acetabular and femoral elements of a converged frame.
StressFields acetabular_fields(const JointModel& model, const FrameResult& frame);
StressFields femoral_fields(const JointModel& model, const FrameResult& frame);
/// Of the soft labrum's. @throws Error bad_input where the model has none
StressFields labrum_fields(const JointModel& model, const FrameResult& frame);

}  // namespace coxa::joint
