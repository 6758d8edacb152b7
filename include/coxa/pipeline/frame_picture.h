#pragma once

#include <coxa/mesh/surface_set.h>
#include <coxa/motion/bone_frames.h>
#include <coxa/view/line_plot.h>
#include <coxa/view/pictures.h>

namespace coxa::pipeline {

/// The axes of pelvis and femur on the patient's own bones, and the way in which flexion, adduction
/// and internal rotation count as positive: the thigh led by the same function that makes poses of
/// angles.
view::Image draw_bone_frames(const SurfaceSet& surfaces, const motion::BoneFrames& frames,
                             Side side);

/// The three angles over time, with their 95 % intervals where known.
view::LinePlot angle_plot(const motion::HipMotion& motion);

}  // namespace coxa::pipeline
