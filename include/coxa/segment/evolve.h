#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/segment/body.h>
#include <coxa/segment/segment.h>

#include <span>
#include <string>
#include <vector>

namespace coxa::segment {

/// One resolution of the search: how far, how smooth, how free.
struct Resolution {
  std::size_t coarsening =
      0;  ///< levels below the finest on which the particles live (limited by the model)
  double range = 2.0;        ///< mm, profile search to either side
  double image_sigma = 0.0;  ///< mm, smoothing of the image
  double window = 3.0;       ///< mm, extent of the profile that counts
  double affine_k =
      1.0;  ///< 0: the closest affine map of the forces only; 1: the forces themselves
  double level_share = 1.0;  ///< of the finest part in the combination with coarser levels' forces
  int score_smoothing = 4;   ///< passes over neighbours before each vertex chooses its shift
  double model_noise = 2.0;  ///< mm, trust of the statistical fit in a single vertex' match
  /// mm, infinite or > 0: what lies farther from every landmark of a body counts only bit by bit,
  /// nearer places first, so that the model has arrived there when it is looked for.
  double first_reach = kInfinity;
  bool fit_only = false;  ///< bodies follow their fitted shape: no particles are moved freely
  bool smooth = true;     ///< the fit may use the bodies' smooth deformations
};

/// A rigid surface that the bodies may not enter.
using Obstacles = std::vector<TriMesh>;

/// What all bodies evolve in.
///
/// @note refers to its parts, which must outlive it.
struct Surroundings {
  std::span<const PreparedImage> images;  ///< smoothed for the resolution at hand
  std::span<const Obstacles> obstacles;   ///< per body: surfaces it may not enter
  std::span<const TriMesh> hosts;         ///< per body: surface it lies on; empty mesh for none
};

/// Moves all bodies together at one resolution until their mean move is below the tolerance.
///
/// Each iteration matches profiles at the finest vertices, regularises the forces, refits the shape
/// models and takes one backward Euler step of the level's particles.
/// @returns iterations done
int update_bodies(std::vector<Body>& bodies, const Surroundings& surroundings,
                  const Resolution& resolution, const SegmentOptions& options,
                  const Monitor& monitor);

/// "t1" of "t1_fluid": what bones and muscles show; whether fluid parts the cartilages only these
/// show.
std::string base_of(const std::string& contrast);

/// Matches the profiles at the body's present finest positions.
ProfileMatch match_body(const Body& body, std::span<const PreparedImage> images,
                        const Resolution& resolution, double gradient_weight);

}  // namespace coxa::segment
