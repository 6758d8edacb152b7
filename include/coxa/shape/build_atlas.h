#pragma once

#include <coxa/core/monitor.h>
#include <coxa/image/volume.h>
#include <coxa/shape/atlas.h>
#include <coxa/shape/profiles.h>
#include <coxa/shape/registration.h>

#include <map>
#include <string>
#include <vector>

namespace coxa::shape {

/// An image of an example hip.
struct ExampleImage {
  std::string contrast;  ///< "t1", "dess", …
  Volume volume;         ///< in the frame of the hip's surfaces
};

/// One hip: surfaces of some structures as a right hip, origin at the femoral head centre, LPS
/// axes, mm.
struct HipExample {
  std::string name;  ///< for example "libhip/m2/left"
  std::map<std::string, TrustedSurface> surfaces;
  std::vector<ExampleImage> images;
};

struct StructureOptions {
  double edge = 2.0;  ///< mm, > 0: edge length of the finest triangulation
  int n_levels = 4;   ///< >= 3 resolutions
};

struct AtlasOptions {
  std::map<std::string, StructureOptions> structures = {{"femur", {2.4, 4}},
                                                        {"hip_bone", {2.8, 4}},
                                                        {"femoral_cartilage", {1.6, 3}},
                                                        {"acetabular_cartilage", {1.4, 3}}};
  double variance_share = 0.98;  ///< in (0, 1], explained by the modes kept
  ProfileOptions profiles;
  RegistrationOptions registration;
};

/// Generic models, shape modes and intensity profiles from example hips.
///
/// For each structure the first example that has it gives the triangulation; it is registered to
/// every example, the mean of these to every example again, so that the result hardly depends on
/// which came first.
/// @throws Error bad_input if a structure of the options is in no example
/// @note   about 5 s per hip and structure; bit-identical for any number of threads
Atlas build_atlas(const std::vector<HipExample>& examples, const AtlasOptions& options = {},
                  const Monitor& monitor = {});

/// Landmarks of the mean surfaces by geometric rules (docs/shape.md); those whose structure is
/// missing are left out.
Landmarks find_landmarks(const std::map<std::string, TriMesh>& mean_surfaces);

}  // namespace coxa::shape
