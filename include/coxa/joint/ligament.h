#pragma once

#include <coxa/core/types.h>

#include <string>

namespace coxa::joint {

/// A band from the hip bone to the femur that pulls and never pushes; it has no width and slides
/// freely on the head.
struct Ligament {
  std::string name;               ///< letters, digits and underscores
  Vec3 origin = Vec3::Zero();     ///< mm, on the hip bone, image frame
  Vec3 insertion = Vec3::Zero();  ///< mm, on the femur in the image pose, image frame
  double stiffness = 0.0;         ///< N/mm, > 0: modulus times cross-section over slack length
  double slack_length = 0.0;      ///< mm, > 0: as long as it is shorter it hangs loose
  /// mm, >= 0: of the sphere about the joint centre, moving with the femur, that it goes around; 0:
  /// it goes straight, through whatever is in the way.
  double wrap_radius = 0.0;
};

/// Length in the image pose, mm; `centre` is the joint centre.
double image_length(const Ligament& ligament, const Vec3& centre);

}  // namespace coxa::joint
