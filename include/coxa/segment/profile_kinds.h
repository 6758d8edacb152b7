#pragma once

#include <coxa/mesh/simplex_mesh.h>
#include <coxa/shape/atlas.h>

namespace coxa::segment {

/// The few kinds of profile that the border of a structure has, and where each is to be expected.
///
/// What lies outside a bone differs between people: muscle here, fat there. A mean profile is then
/// like neither; the kinds are like what will be found.
struct ProfileKinds {
  MatX mean;   ///< K×samples, as in ProfileSet
  MatX share;  ///< V×K, in [0, 1]: how common each kind is about a vertex; rows sum to 1
};

/// Clusters of a set's mean profiles (k-means, the samples near the border counting most).
///
/// @param neighbours of the finest level's vertices
/// Source: clustering of intensity profiles by regions, Chung and Delingette 2013
ProfileKinds profile_kinds(const shape::ProfileSet& set, const Triangles& neighbours);

}  // namespace coxa::segment
