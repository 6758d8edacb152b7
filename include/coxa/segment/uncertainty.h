#pragma once

#include <coxa/image/volume.h>
#include <coxa/mesh/tri_mesh.h>

#include <span>

namespace coxa::segment {

/// What is known about how well a surface was found, per vertex.
struct Evidence {
  VecX confidence;        ///< [0, 1], of the profiles' match
  VecX border_deviation;  ///< mm, of a bone's border as its profiles tell it (bone_border.h);
                          ///< `kUnknownBorder` where they tell nothing
  VecX view_depth;        ///< mm inside the images; negative: outside of all
  VecX half_voxel;        ///< mm along the normal, in the image that blurs it least
  VecX rim_distance;      ///< mm, from a layer's rim; infinite on bones
  VecX far_side;          ///< 1 on the side of a layer that faces away from its bone
};

/// mm: a border that no profile tells.
inline constexpr double kUnknownBorder = 3.0;

/// How large the 95 % interval is, in view
///   exp(constant + doubt (1 - confidence) + border log(deviation / 1 mm) + edge exp(-depth / 4 mm)
///       + blur log(half voxel / 0.4 mm) + rim exp(-distance / 3 mm) + far_side)
/// and outside, where the shape model completes the surface, exp(beyond + growth log(1 + outside /
/// 5 mm)), mm.
struct Calibration {
  double constant = 0.0;
  double doubt = 0.0;
  double border = 0.0;
  double edge = 0.0;
  double blur = 0.0;
  double rim = 0.0;
  double far_side = 0.0;
  double beyond = 0.0;
  double growth = 0.0;
};

/// Half width of the 95 % interval of each vertex's distance from the true surface, mm.
VecX uncertainties(const Evidence& evidence, const Calibration& calibration);

/// Evidence from where a surface lies in the images; confidence and border are the caller's.
/// @param n_bone_side of a layer: its first triangles, that lie on its bone; 0: a bone
Evidence evidence_of_place(const TriMesh& surface, Index n_bone_side,
                           std::span<const Volume* const> images);

}  // namespace coxa::segment
