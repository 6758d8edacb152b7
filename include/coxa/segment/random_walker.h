#pragma once

#include <coxa/core/monitor.h>
#include <coxa/core/types.h>

#include <array>
#include <vector>

namespace coxa::segment {

/// Voxels that are linked with their neighbours; a link lets more through the greater its weight.
struct WalkGraph {
  std::vector<std::array<Index, 3>> next;    ///< of every voxel: those that follow, or -1
  std::vector<std::array<float, 3>> weight;  ///< > 0, of the links to these
};

/// How likely a label is at the voxels that may get it at all, before the links are looked at.
struct WalkPrior {
  std::vector<Index> voxels;  ///< ascending
  std::vector<float> share;   ///< >= 0, each
};

struct WalkOptions {
  double prior_weight = 0.02;  ///< > 0, of a share of 1 against a link of weight 1
  double other_share = 3e-4;   ///< > 0, of being none of them, everywhere
  double tolerance = 1e-3;     ///< of the residual, relative
  int iterations = 200;        ///< >= 1, at most
};

/// The likeliest label of every voxel by random walks with priors (Grady 2005): the share of walks
/// from the voxel along the links that end at a prior of each label.
///
/// For each label, (L + prior_weight (sum of all shares)) x = prior_weight share, L the graph's
/// Laplacian. Voxels on which no prior has an opinion follow those that they are well linked to.
/// @returns by voxel: number of the label, -1 where none of them is likelier than each label
/// @throws Error bad_input if an option is out of range
/// @note    bit-identical for any number of threads
std::vector<int> likeliest_labels(const WalkGraph& graph, const std::vector<WalkPrior>& priors,
                                  const WalkOptions& options = {}, const Monitor& monitor = {});

}  // namespace coxa::segment
