#pragma once

#include <coxa/joint/joint_model.h>
#include <coxa/joint/live.h>
#include <coxa/joint/simulate.h>
#include <coxa/motion/hip_motion.h>
#include <coxa/serve/bundle.h>

#include <nlohmann/json.hpp>

#include "body_surface.h"

namespace coxa::serve {

/// What is drawn of the two cartilages.
struct LiveSurfaces {
  BodySurface acetabular, femoral;
};

/// Status, pose and figures of a live state, for the browser.
nlohmann::json live_meta(const joint::LiveHip::Step& step, const motion::HipAngles& angles);

/// How far a step was off, beside the exact state at the same pose.
nlohmann::json live_error(const joint::FrameResult& exact, const joint::FrameResult& step);

/// Adds positions and values at the drawn vertices, in 16 bits: of `field` alone, or of all where
/// it is empty.
void add_live_state(Bundle& bundle, const joint::JointModel& model, const LiveSurfaces& surfaces,
                    const joint::FrameResult& frame, const std::string& field);

}  // namespace coxa::serve
