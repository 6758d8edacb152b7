#pragma once

#include <coxa/core/monitor.h>
#include <coxa/image/volume.h>
#include <coxa/segment/profile_kinds.h>
#include <coxa/shape/atlas.h>

#include <string>
#include <vector>

namespace coxa::segment {

/// An image with what profile matching needs to know of it.
struct PreparedImage {
  Volume volume;
  double intensity_range = 1.0;  ///< between the 2nd and 98th percentile of the values, > 0
  std::string contrast;          ///< the atlas' profiles to compare with
};

/// Bias-corrected (on request) copy with its intensity range. @throws Error bad_input for an
/// unusable image
PreparedImage prepare_image(const Volume& volume, bool correct_bias, const Monitor& monitor = {});

/// How profiles are compared at one resolution.
struct ProfileSearch {
  double range = 4.0;   ///< mm to either side
  double window = 3.0;  ///< mm, Gaussian weight of a sample by its distance from the border
  double gradient_weight = 0.3;  ///< of the border's gradient beside the correlation
  double shift_penalty = 0.1;    ///< of a match at the end of the range
  double image_sigma = 0.0;      ///< mm, smoothing of the image; the references are smoothed alike
};

/// A row per vertex, in one piece of memory.
using ScoreTable = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Scores of moving each vertex along its normal: row v, column s is the shift (s - n_each_way) *
/// step.
struct ProfileScores {
  double step = 0.5;  ///< mm
  Index n_each_way = 0;
  ScoreTable score;        ///< V×(2 n_each_way + 1); NaN where the profile leaves the image
  ScoreTable correlation;  ///< same shape: normalised cross-correlation alone, in [-1, 1]
};

/// Row i of the reference belongs to position i.
/// @param kinds of the reference: the best-scoring of the kinds common about a vertex counts, not
///              the vertex' own mean; null: its own
ProfileScores score_profiles(const PreparedImage& image, const Points& positions,
                             const Points& normals, const shape::ProfileSet& reference,
                             const ProfileSearch& search, const ProfileKinds* kinds = nullptr);

/// Adds the scores of a second image: mean where both see the profile.
void update_combined(ProfileScores& scores, const ProfileScores& other);

/// Replaces every score by its weighted mean with the three neighbours', `passes` times:
/// neighbouring vertices agree on a common shift before each chooses its own.
void update_smoothed(ProfileScores& scores, const Triangles& neighbours, const VecX& reliability,
                     int passes);

/// The best shift of every vertex.
struct ProfileMatch {
  VecX shift;        ///< mm along the normal, sub-sample by a parabola; 0 where unseen
  VecX correlation;  ///< at the shift; 0 where unseen
  VecX here;         ///< correlation at the present place; 0 where unseen
  VecX confidence;   ///< in [0, 1]: correlation, how distinct the best is, and the reference's
                     ///< reliability
  VecX seen;         ///< 1 where the image shows the profile at its present place, else 0
};
ProfileMatch best_match(const ProfileScores& scores, const VecX& reliability);

}  // namespace coxa::segment
