#pragma once

#include <coxa/core/monitor.h>
#include <coxa/shape/atlas.h>
#include <coxa/shape/registration.h>

#include <map>
#include <string>
#include <vector>

namespace coxa::shape {

/// One hip: surfaces of some structures as a right hip, origin at the femoral head centre, LPS
/// axes, mm.
struct HipExample {
  std::string name;  ///< for example "libhip/m2/left"
  std::map<std::string, TrustedSurface> surfaces;
  /// Per cartilage, how many of its first triangles lie on the bone; where it is not said, the bone
  /// itself must be among the surfaces.
  std::map<std::string, Index> bone_side_faces;
};

struct StructureOptions {
  double edge = 2.0;  ///< mm, > 0: edge length of the finest triangulation; cartilages take the
                      ///< triangles of the example that comes nearest
  int n_levels = 4;   ///< >= 3 resolutions
};

struct AtlasOptions {
  std::map<std::string, StructureOptions> structures = {{"femur", {2.4, 4}},
                                                        {"hip_bone", {2.8, 4}},
                                                        {"femoral_cartilage", {1.6, 3}},
                                                        {"acetabular_cartilage", {2.0, 3}}};
  double variance_share = 0.99;  ///< in (0, 1], explained by the modes kept
  double cartilage_gap = 0.05;   ///< mm, >= 0, between the mean cartilages and their bones
  RegistrationOptions registration;
};

/// Generic models and shape modes from example hips; intensity profiles are added by
/// update_profiles.
///
/// For each bone the first example that has it gives the triangulation; it is registered to every
/// example, the mean of these to every example again, so that the result hardly depends on which
/// came first. A cartilage is registered by its bone side and laid on the
/// mean of its bone.
/// @throws Error bad_input if a structure of the options is in no example
/// @note   a few seconds per hip and structure; bit-identical for any number of threads
Atlas build_atlas(const std::vector<HipExample>& examples, const AtlasOptions& options = {},
                  const Monitor& monitor = {});

/// The bone each cartilage lies on.
std::string bone_under(const std::string& cartilage);

/// Landmarks of the mean surfaces by geometric rules (docs/shape.md); those whose structure is
/// missing are left out.
Landmarks find_landmarks(const std::map<std::string, TriMesh>& mean_surfaces);

}  // namespace coxa::shape
