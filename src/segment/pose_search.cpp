#include <coxa/segment/pose_search.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>

#include <algorithm>
#include <cmath>

#include "pose_fit.h"
#include "pose_score.h"

namespace coxa::segment {
namespace {

/// mm. Image and references are smoothed so far that a grid of this spacing misses nothing.
constexpr double kGrid = 10.0;
constexpr double kSmoothing = 3.0;
/// Of the smoothing: voxels so large lose nothing of a smoothed image.
constexpr double kVoxelShare = 0.7;
/// Vertices per bone that are compared at each place: enough to tell a hip, few enough to try a
/// hundred thousand; and at the places that are left.
constexpr Index kProbes = 100, kManyProbes = 300;
/// Places that are improved, of them those to which the shape models are fitted coarsely, then
/// finely, and how far apart they are, mm. On simulated images the hip is among the first 30 of the
/// grid, 6 of the improved and 3 of the coarsely fitted.
constexpr std::size_t kImproved = 80, kFitted = 8, kUpright = 3, kFinelyFitted = 4;
constexpr double kApart = 18.0;
/// mm. Fits that differ by less lead to one result.
constexpr double kAlike = 3.0;
/// How far off a place of the grid is, and, once fitted, the bones. The finer fit tells a hip from
/// what looks like one from afar: at the right place the correlation stays as the image gets
/// sharper.
constexpr PlaceFit kCoarseFit{.range = 12.0, .sigma = kSmoothing, .window = 5.0};
constexpr PlaceFit kFineFit{.range = 6.0, .sigma = 1.5, .window = 2.5};
/// Mean correlation of a hip, and how far it is above other places. Hips of the other side and
/// images without one reached 0.19, hips 0.28.
constexpr double kLeastScore = 0.20, kLeastMargin = 0.05;
/// rad. Patients lie on the table within about this of the atlas' orientation.
constexpr double kTurn = 0.26;
/// mm. So far inside the image lies the joint's centre: an image that cuts the head shows no joint,
/// and at its border few vertices are in view, which fit by chance.
constexpr double kInside = 15.0;

struct Candidate {
  Similarity pose;
  Eigen::Index contrast = 0;
  double score = -kInfinity;
};

std::vector<Mat3> orientations() {
  std::vector<Mat3> turns = {Mat3::Identity()};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double angle : {-kTurn, kTurn}) {
      turns.push_back(rotation_from_vector(angle * Vec3::Unit(axis)));
    }
  }
  return turns;
}

std::vector<Candidate> all_candidates(const Volume& volume) {
  const std::vector<Mat3> turns = orientations();
  std::vector<Candidate> candidates;
  Vec3 extent;
  for (int a = 0; a < 3; ++a) {
    extent[a] = (volume.size[static_cast<std::size_t>(a)] - 1) * volume.spacing[a];
  }
  for (double z = kInside; z <= extent.z() - kInside; z += kGrid)
    for (double y = kInside; y <= extent.y() - kInside; y += kGrid)
      for (double x = kInside; x <= extent.x() - kInside; x += kGrid) {
        const Vec3 p = volume.origin + volume.direction * Vec3(x, y, z);
        for (const Mat3& R : turns) candidates.push_back({{1.0, {R, p}}, 0, -kInfinity});
      }
  return candidates;
}

void update_score(Candidate& candidate, const PoseScore& score, const Volume& volume) {
  candidate.score = score.at(candidate.pose).maxCoeff(&candidate.contrast) -
                    size_cost(candidate.pose.scale) - turn_cost(candidate.pose.X.R);
  if (!in_view(volume, candidate.pose.X.p, kInside)) candidate.score = -kInfinity;
}

/// The best-scoring candidates that are apart from each other, best first.
std::vector<Candidate> best_apart(std::vector<Candidate> candidates, std::size_t count) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<Candidate> kept;
  for (const Candidate& candidate : candidates) {
    const bool near = std::any_of(kept.begin(), kept.end(), [&](const Candidate& k) {
      return (k.pose.X.p - candidate.pose.X.p).norm() < kApart;
    });
    if (!near) kept.push_back(candidate);
    if (kept.size() == count) break;
  }
  return kept;
}

/// One step along a direction of pose space: three of place, three of turn, one of size.
Similarity stepped(const Similarity& pose, int direction, double share) {
  constexpr double kPlace = 5.0, kAngle = 0.12, kSize = 0.05;  // mm, rad, of the largest step
  Similarity moved = pose;
  if (direction < 3) {
    moved.X.p += share * kPlace * Vec3::Unit(direction);
  } else if (direction < 6) {
    moved.X.R = rotation_from_vector(share * kAngle * Vec3::Unit(direction - 3)) * pose.X.R;
  } else {
    moved.scale = std::clamp(pose.scale * (1.0 + share * kSize), 0.8, 1.2);
  }
  return moved;
}

/// The nearest best pose, by steps along one direction after the other that grow smaller.
Candidate improved(Candidate best, const PoseScore& score, const Volume& volume) {
  update_score(best, score, volume);
  for (const double share : {1.0, 0.5, 0.25}) {
    for (bool better = true; better;) {
      better = false;
      for (int direction = 0; direction < 7; ++direction) {
        for (const double sign : {-1.0, 1.0}) {
          Candidate next = best;
          next.pose = stepped(best.pose, direction, sign * share);
          update_score(next, score, volume);
          if (next.score < best.score + 1e-4) continue;
          best = next;
          better = true;
        }
      }
    }
  }
  return best;
}

/// The first few once more as the atlas lies: bones that are round where the image shows them turn
/// into a valley from which no fit comes back.
std::vector<Candidate> with_upright(std::vector<Candidate> candidates) {
  const std::size_t n = std::min(candidates.size(), kUpright);
  for (std::size_t i = 0; i < n; ++i) {
    candidates.push_back(candidates[i]);
    candidates.back().pose.X.R = Mat3::Identity();
  }
  return candidates;
}

/// The places, each fitted from where it is; best first.
std::vector<PlacedBones> best_fitted(std::vector<PlacedBones> places, const PreparedImage& image,
                                     const PlaceFit& fit, const SegmentOptions& options,
                                     const Monitor& monitor) {
  for (PlacedBones& place : places) {
    monitor.check_cancelled();
    update_placed(place, image, fit, options);
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const PlacedBones& a, const PlacedBones& b) { return a.score > b.score; });
  return places;
}

/// mm, mean distance of corresponding vertices of the bones.
double apart(const std::vector<Points>& a, const std::vector<Points>& b) {
  double sum = 0.0;
  for (std::size_t bone = 0; bone < a.size(); ++bone)
    sum += (a[bone] - b[bone]).rowwise().norm().mean();
  return sum / static_cast<double>(a.size());
}

/// The first of the places with what rivals it there, and how far it is above all other places.
FoundPose found_pose(const std::vector<PlacedBones>& places) {
  const PlacedBones& best = places.front();
  FoundPose found{{}, joint_centre(best), best.contrast, best.score, best.score + 1.0};
  for (const PlacedBones& place : places) {
    const bool here = (joint_centre(place) - found.centre).norm() <= kApart;
    if (!here) found.margin = std::min(found.margin, best.score - place.score);
    if (!here || place.score < best.score - kLeastMargin) continue;
    std::vector<Points> start;
    for (const Body& body : place.bodies) start.push_back(body.fit.points);
    const bool known = std::any_of(found.starts.begin(), found.starts.end(),
                                   [&](const auto& other) { return apart(start, other) < kAlike; });
    if (!known) found.starts.push_back(std::move(start));
  }
  return found;
}

/// A start that another place rivals, or that fits little, is none: segmentation from a wrong place
/// can look sure of itself.
void check_found(const FoundPose& found) {
  const char* const advice =
      "; give at least six landmarks (--landmarks), check the side and that the hip is in the "
      "image";
  if (found.score < kLeastScore) {
    fail(ErrorCode::below_quality,
         "the hip is not found without landmarks: the best place fits by ", found.score, ", and ",
         kLeastScore, " is the least", advice);
  }
  if (found.margin < kLeastMargin) {
    fail(ErrorCode::below_quality,
         "the hip is not found without landmarks: the best place fits by ", found.score,
         ", another one by only ", found.margin, " less, and ", kLeastMargin, " is the least",
         advice);
  }
}

/// mm. What of a bone moves with a landmark: far enough about it that three dimensions are there.
constexpr double kCarriedReach = 25.0;

}  // namespace

shape::Landmarks landmarks_at(const std::vector<Points>& placed,
                              const std::vector<const shape::StructureModel*>& bones,
                              const shape::Atlas& atlas) {
  std::size_t n = 0;
  for (const Points& bone : placed) n += static_cast<std::size_t>(bone.rows());
  Points mean(n, 3), image(n, 3);
  Eigen::Index row = 0;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const Eigen::Index rows = placed[b].rows();
    mean.middleRows(row, rows) = bones[b]->hierarchy.levels.back().points;
    image.middleRows(row, rows) = placed[b];
    row += rows;
  }
  shape::Landmarks carried;
  for (const auto& [name, position] : atlas.landmarks) {
    const VecX distance = (mean.rowwise() - position.transpose()).rowwise().norm();
    const double reach = distance.minCoeff() + kCarriedReach;
    const VecX weight = (-0.5 * (distance / reach).array().square()).exp();
    const Similarity move = fit_similarity(mean, image, weight);
    carried[name] = move.X * Vec3(move.scale * position);
  }
  return carried;
}

FoundPose find_pose(const std::vector<const shape::StructureModel*>& bones,
                    const std::vector<PreparedImage>& images, const SegmentOptions& options,
                    const Monitor& monitor) {
  const Volume& volume = images.front().volume;
  PreparedImage image = images.front();
  image.volume = smoothed(volume, kSmoothing);
  const Volume coarse = resampled_isotropic(image.volume, kVoxelShare * kSmoothing);
  const PoseScore few(bones, coarse, image.intensity_range, kSmoothing, kProbes),
      many(bones, coarse, image.intensity_range, kSmoothing, kManyProbes);
  std::vector<Candidate> candidates = all_candidates(volume);
  require(!candidates.empty(), "the image is too small to look for a hip in");
  const auto update_all = [&](const auto& update) {
    parallel_for(static_cast<std::int64_t>(candidates.size()), [&](Index i) {
      if (!monitor.cancelled()) update(candidates[static_cast<std::size_t>(i)]);
    });
    monitor.check_cancelled();
  };
  update_all([&](Candidate& c) { update_score(c, few, volume); });
  candidates = best_apart(std::move(candidates), kImproved);
  update_all([&](Candidate& c) { c = improved(c, many, volume); });
  candidates = best_apart(std::move(candidates), kFitted);

  candidates = with_upright(std::move(candidates));
  std::vector<PlacedBones> places;
  for (const Candidate& candidate : candidates) {
    const std::string& contrast = few.contrasts()[static_cast<std::size_t>(candidate.contrast)];
    places.push_back(placed_bones(bones, candidate.pose, contrast));
  }
  places = best_fitted(std::move(places), image, kCoarseFit, options, monitor);
  places.resize(std::min(places.size(), kFinelyFitted));
  image.volume = smoothed(volume, kFineFit.sigma);
  places = best_fitted(std::move(places), image, kFineFit, options, monitor);
  const FoundPose found = found_pose(places);
  check_found(found);
  return found;
}

}  // namespace coxa::segment
