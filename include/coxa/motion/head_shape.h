#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <string>
#include <vector>

namespace coxa::motion {

/// How femoral heads differ from spheres: radius R (1 + sum a_k Y_k(direction)) with real spherical
/// harmonics of degrees 2 and up, each of mean square 1 over the sphere, in axes of the head.
///
/// Axes: z along the neck (lateral), y superior, x so that right hips are right-handed and left
/// hips their mirror images.
struct HeadShape {
  Index degree = 4;  ///< >= 2, largest of the harmonics
  VecX mean;         ///< (degree + 1)² - 4 coefficients, by degree, in it m = 0, cos 1, sin 1, …
  VecX spread;       ///< degree - 1, > 0: standard deviation of one coefficient of each degree
  std::string source;  ///< what it was learned from
};

/// @throws Error bad_input when sizes or signs are wrong
void check_head_shape(const HeadShape& shape);

/// Values of the harmonics of degrees 2 to `degree` at unit directions: n × ((degree + 1)² - 4).
MatX head_harmonics(const Points& directions, Index degree);

/// A femur whose head is seen whole.
struct HeadExample {
  TriMesh femur;  ///< LPS mm
  Side side = Side::right;
};

/// Mean, drawn half-way to a sphere, and spread of the heads of at least two femora.
/// @throws Error bad_input for fewer, or where no head is found
/// Source: docs/motion.md section 2.
HeadShape learn_head_shape(const std::vector<HeadExample>& examples, Index degree = 4);

}  // namespace coxa::motion
