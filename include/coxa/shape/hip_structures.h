#pragma once

namespace coxa::shape {

/// The bones and cartilages of a hip joint, by the names they have in atlases, files and results.
inline constexpr const char* kHipStructures[] = {"femur", "hip_bone", "femoral_cartilage",
                                                 "acetabular_cartilage"};

}  // namespace coxa::shape
