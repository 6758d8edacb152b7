#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/simplex_mesh.h>

#include <map>
#include <string>
#include <vector>

namespace coxa::shape {

/// Intensities along the outward normal of every finest-level vertex, for one MRI contrast.
struct ProfileSet {
  std::string contrast;  ///< "t1", "dess", …
  double step = 0.5;     ///< mm between samples
  Index n_inside = 0;    ///< samples inside; sample n_inside is at the surface
  MatX mean;             ///< V×samples, each row with mean 0 and norm 1 where informative
  VecX reliability;      ///< V in [0, 1]: agreement of the training profiles
};

/// Point-distribution model over the finest level's vertices of one structure.
struct ShapeModes {
  MatX modes;       ///< 3V×k orthonormal columns, rows grouped per vertex (x, y, z)
  VecX deviations;  ///< k standard deviations, mm (of the coordinate along the mode)
};

/// Generic model of one structure. All hips are stored as right hips in the atlas frame
/// (origin at the mean femoral head centre, LPS axes, mm); left hips are mirrored in x.
struct StructureModel {
  std::string name;            ///< femur, hip_bone, femoral_cartilage, acetabular_cartilage, …
  SimplexHierarchy hierarchy;  ///< mean shape, at least three resolutions, coarse first
  ShapeModes shape;            ///< of the finest level, after similarity alignment of the structure
  std::vector<ProfileSet> profiles;
  std::vector<SimplexParameters> reference;  ///< shape memory: of the finest mean
  bool generic = false;                      ///< built from anatomy, not from examples
  /// Soft, between the bones: its mean lies as the mean bones carry it, and profiles are learned
  /// for contrasts only, without regard to fluid in the joint.
  bool muscle = false;
  /// Of a cartilage: n, so that finest vertices 0 … n-1 lie on the bone and vertex i + n is on the
  /// articular side opposite vertex i; 0 for other structures.
  Index n_bone_side = 0;
  /// Finest vertex nearest to each landmark that lies on this surface: carries it to any shape.
  std::map<std::string, Index> landmark_vertices;
  /// mm, root mean square over the examples: what the modes of the other examples cannot describe
  /// of an example left out; NaN for fewer than three examples.
  double leave_one_out_error = 0.0;
};

/// Mean landmark positions in the atlas frame, by name without side suffix.
using Landmarks = std::map<std::string, Vec3>;

struct Atlas {
  std::vector<StructureModel> structures;
  Landmarks landmarks;
  std::vector<std::string>
      subjects;             ///< examples it was computed from, for example "libhip/m2/left"
  std::string attribution;  ///< licences and sources of those examples
};

/// The structure's model. @throws Error bad_input naming what the atlas has, when it is absent
const StructureModel& structure(const Atlas& atlas, const std::string& name);

}  // namespace coxa::shape
