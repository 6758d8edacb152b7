#pragma once

#include <coxa/segment/body.h>

namespace coxa::segment {

/// What the examples do not show of a structure: kinds of its profiles, and smooth deformations of
/// these standard deviations, mm, over 60 and over 25 mm.
Preparation prepared(const shape::StructureModel& model, double long_deviation,
                     double short_deviation);

}  // namespace coxa::segment
