#pragma once

#include <coxa/core/rng.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/shape/atlas.h>

#include <map>
#include <string>

namespace coxa::shape {

struct VirtualHipOptions {
  double spread = 1.0;  ///< >= 0: of the shape modes' coefficients, in standard deviations
  double off_model_rms =
      0.0;  ///< mm, >= 0: root mean square of a smooth deformation that no mode knows
  double correlation = 15.0;  ///< mm, > 0: length over which that deformation is alike
  double least_gap = 0.05;    ///< mm, >= 0, between the articular surfaces
};

/// Closed surfaces of a hip that nobody has, by structure, as a right hip in the atlas frame.
/// Triangle i belongs to vertex i of the structure's finest level.
using VirtualHip = std::map<std::string, TriMesh>;

/// Draws a hip from the atlas.
///
/// Bones by their modes; cartilages ride on them, their thickness by their own modes; the pelvic
/// part is then scaled and moved so that the joint fits, and cartilage that would overlap is
/// thinned. Last, all are deformed together by a smooth random field. Places where a surface cuts
/// itself are smoothed; a draw where that does not help is thrown away.
/// @throws Error bad_input if an option is out of range or the atlas lacks a cartilage's bone;
///         no_convergence if no usable hip comes out of many draws (the spread is too large)
VirtualHip draw_virtual_hip(const Atlas& atlas, Rng& rng, const VirtualHipOptions& options = {});

/// The mean hip: the mean surface of every bone and cartilage.
VirtualHip mean_hip(const Atlas& atlas);

}  // namespace coxa::shape
