#pragma once

#include <coxa/joint/joint_result.h>

#include "equilibrium.h"

namespace coxa::joint {

/// Fills what a frame tells of the labrum, after its balance: displacement, pressure, strain, share
/// of the contact force.
void update_labrum_figures(FrameResult& frame, const JointModel& model, const LabrumBody& body,
                           const HipState& state);

}  // namespace coxa::joint
