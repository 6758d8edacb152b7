#pragma once

#include <coxa/image/volume.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/shape/atlas.h>

#include <map>
#include <string>
#include <vector>

namespace coxa::shape {

struct ProfileOptions {
  double step = 0.5;     ///< mm between samples, > 0
  Index n_inside = 10;   ///< samples inside, >= 1
  Index n_outside = 10;  ///< samples outside, >= 1
};

/// One image in which a structure's vertices are known.
struct ProfileExample {
  const Volume* image = nullptr;  ///< must outlive the call
  Points points;                  ///< V×3, mm, image frame
  Points normals;                 ///< V×3, unit, outward
};

/// Mean profile of every vertex over the examples that show it, and how far they agree.
///
/// Each profile is taken to mean 0 and norm 1 before averaging, so that gain and offset of an image
/// do not matter; the mean is normalised again. Reliability is the length of the mean before that:
/// 1 where all examples agree, 0 where none shows the vertex or they contradict each other.
/// @throws Error bad_input if the examples differ in their number of vertices
ProfileSet learn_profiles(const std::vector<ProfileExample>& examples, const std::string& contrast,
                          const ProfileOptions& options = {});

/// A hip whose surfaces and image are both known.
struct ImagedHip {
  std::string contrast;  ///< class of profiles: "t1", "dess", "t1_fluid", …
  const std::map<std::string, TriMesh>* surfaces = nullptr;  ///< triangle i is finest vertex i
  const Volume* image = nullptr;  ///< in the same frame; both must outlive the call
};

/// The finest vertices of a structure where a surface in correspondence with the atlas has them.
/// @param surface  triangle i is finest vertex i   @param image  must outlive the example
/// @throws Error bad_input if the surface has other triangles than the atlas
ProfileExample profile_example(const StructureModel& model, const TriMesh& surface,
                               const Volume& image);

/// Gives every structure of the atlas one profile set per class of images, in order of the names.
void update_profiles(Atlas& atlas, const std::vector<ImagedHip>& hips,
                     const ProfileOptions& options = {});

}  // namespace coxa::shape
