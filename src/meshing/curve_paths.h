#pragma once

#include "feature_curves.h"
#include "tet_grid.h"

namespace coxa::meshing {

/// A node of the boundary chosen for a corner, or for a curve.
struct FeatureNode {
  Index node = 0;
  Index curve = -1, corner = -1;  ///< one of them; -1: none
};

/// Chooses a node of the boundary for every corner of the surface and, for every curve, those of
/// the path of boundary edges that runs along it. None is moved; they stay until they are drawn.
std::vector<FeatureNode> choose_paths(TetGrid& grid, const FeatureCurves& features);

/// Draws the chosen nodes nearer to their corners and curves, as far as the elements allow it.
/// Those on their curves slide along it from then on.
void draw_to_features(TetGrid& grid, const FeatureCurves& features,
                      const std::vector<FeatureNode>& chosen);

/// Gives the nodes up that did not get to their places.
void release_missed(TetGrid& grid, const FeatureCurves& features,
                    const std::vector<FeatureNode>& chosen);

}  // namespace coxa::meshing
