#pragma once

#include <coxa/segment/model_fit.h>
#include <coxa/segment/profile_search.h>
#include <coxa/shape/atlas.h>

#include <map>
#include <string>

namespace coxa::segment {

/// What is made of a model once, before its body moves.
struct Preparation {
  SmoothModes smooth;                         ///< deformations allowed beside the model's modes
  std::map<std::string, ProfileKinds> kinds;  ///< by contrast
};

/// A structure on its way from the atlas to the image.
///
/// @note refers to the model and its preparation, which must outlive it.
struct Body {
  const shape::StructureModel* model = nullptr;
  const Preparation* prepared = nullptr;  ///< null: the model's own modes and mean profiles only
  Points points;                          ///< V×3 finest level, LPS mm
  ModelFit fit;                           ///< the shape model's opinion
  ProfileMatch match;                     ///< of the last iteration, finest level
  VecX reach;  ///< V, mm: from the bone's nearest given landmark in the mean shape; empty: none
               ///< given
  VecX seat;   ///< V: 1 on vertices that lie on the host's surface; empty without a host
};

/// A body where its model comes nearest to the finest mean points placed in the image.
Body placed_body(const shape::StructureModel& model, Points placed);

/// The finest level's topology with the body's positions.
SimplexMesh finest_mesh(const Body& body);

/// The body's surface, a vertex per face of its finest mesh.
///
/// The fitted shape's dual surface, moved by the body's displacement from it: exact for smooth
/// displacements, while the dual of the body's own positions would blow up what noise they carry.
TriMesh surface_mesh(const Body& body);

/// Positions of a level's vertices that belong to finest positions `fine`: the level's mean shape
/// at `pose`, moved by the mean displacement of the fine vertices that follow each coarse one.
/// (Means of positions would shrink.)
Points level_points(const SimplexHierarchy& hierarchy, std::size_t level, const Points& fine,
                    const Similarity& pose);

/// Every row of `points` at the pose.
Points posed(const Points& points, const Similarity& pose);

/// A field on the finest level -> means at a level, and back.
Points field_at_level(const SimplexHierarchy& hierarchy, std::size_t level, const Points& field,
                      const VecX& weight);
VecX values_at_level(const SimplexHierarchy& hierarchy, std::size_t level, const VecX& values);
Points field_at_finest(const SimplexHierarchy& hierarchy, std::size_t level, const Points& field);

}  // namespace coxa::segment
