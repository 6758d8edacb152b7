#pragma once

#include <coxa/core/monitor.h>
#include <coxa/shape/atlas.h>
#include <coxa/shape/build_atlas.h>

#include <map>
#include <string>
#include <vector>

namespace coxa::shape {

struct MuscleOptions {
  double triangle_area = 11.0;     ///< mm², > 0: wanted of the finest triangulation …
  Index least_triangles = 500;     ///< … of which there are at least so many …
  Index most_triangles = 4000;     ///< … and at most so many
  int n_levels = 3;                ///< >= 3 resolutions; small muscles get fewer
  double variance_share = 0.98;    ///< in (0, 1], explained by the modes kept
  double control_spacing = 10.0;   ///< mm, > 0, of the bones' points that carry the muscles
  double control_smoothness = 20;  ///< mm, >= 0: how far single points may be missed
  /// A muscle of an example is already where the bones carry it: no similarity.
  RegistrationOptions registration = {.similarity_iterations = 0,
                                      .lengths = {100.0, 50.0, 25.0, 12.0},
                                      .iterations = 4,
                                      .normal_limit = 0.3,
                                      .largest_distance = 40.0};
};

/// An example whose muscles were brought into the atlas frame by its bones.
struct CarriedMuscles {
  std::string name;
  std::map<std::string, TriMesh> surfaces;  ///< triangle i is finest vertex i of the model
};

/// Adds generic models of muscles to an atlas of bones.
///
/// Thin-plate splines through the bones take every example's muscles to the mean bones: what
/// differs then between examples is the muscles themselves, not size or pose. Each muscle is
/// registered to all examples that have it, whole ones first; the mean lies where these lie.
/// @param names  muscles to add; those no example has are left out
/// @returns the examples in the atlas frame, with the models' triangles
/// @throws Error bad_input if the atlas has no femur or hip bone, or an option is out of range
/// @note   about a second per muscle and example; bit-identical for any number of threads
std::vector<CarriedMuscles> add_muscles(Atlas& atlas, const std::vector<HipExample>& examples,
                                        const std::vector<std::string>& names,
                                        const MuscleOptions& options = {},
                                        const Monitor& monitor = {});

}  // namespace coxa::shape
