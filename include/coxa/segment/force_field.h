#pragma once

#include <coxa/mesh/simplex_mesh.h>

#include <span>

namespace coxa::segment {

/// Mean of a field with its three neighbours', weighted by confidence, `passes` times. Vertices
/// without confidence take their neighbours' values.
Points smoothed_field(const Points& field, const VecX& confidence, const Triangles& neighbours,
                      int passes);

/// What the field looks like at the next coarser resolution: confidence-weighted means over the
/// fine vertices that follow each coarse one, carried back to the fine ones.
Points coarse_part(const Points& field, const VecX& confidence, const LevelMap& map,
                   Index n_coarse);

/// Linear combination of the field with its parts at all coarser resolutions.
///
/// @param maps    from the coarsest level up to the field's own, as in SimplexHierarchy
/// @param share   of the finest part, in [0, 1]; each coarser level takes the same share of the
/// rest
Points combined_levels(const Points& field, const VecX& confidence, std::span<const LevelMap> maps,
                       double share);

/// Closest-affine regularisation: k f + (1 - k)(A x + t - x), the affine map fitted with the
/// confidences. Without 12 confident vertices nothing is fitted, and only k f is left.
Points regularised_by_affine(const Points& positions, const Points& field, const VecX& confidence,
                             double k);

/// The closest rigid motion's field instead.
Points rigid_part(const Points& positions, const Points& field, const VecX& confidence);

/// Fine values -> coarse: normalised transpose of the map (rows of means).
Points restricted(const Points& fine, const VecX& weight, const LevelMap& map, Index n_coarse);
/// Coarse values -> fine.
Points prolonged(const Points& coarse, const LevelMap& map);

}  // namespace coxa::segment
