#pragma once

#include <coxa/shape/atlas.h>

namespace coxa::shape {

/// Scales and moves the pelvic part (hip bone and acetabular cartilage) so that its articular
/// sphere is concentric with the femur's and `gap` mm larger. Does nothing where a cartilage is
/// missing.
void update_joint_fit(Atlas& atlas, double gap);

}  // namespace coxa::shape
