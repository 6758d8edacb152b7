#include <coxa/core/error.h>
#include <coxa/segment/cortex_search.h>
#include <coxa/segment/placement.h>
#include <coxa/segment/pose_search.h>

#include <algorithm>

#include "hip.h"
#include "landmark_reach.h"
#include "result.h"
#include "schedule.h"
#include "stages.h"

namespace coxa::segment {
namespace {

/// So many landmarks are in the image at least; others may have been set in another of the patient.
constexpr int kLeastInImage = 3;

void check_in_image(const std::vector<PreparedImage>& images, const shape::Landmarks& landmarks) {
  const auto inside = std::count_if(landmarks.begin(), landmarks.end(), [&](const auto& landmark) {
    return std::any_of(images.begin(), images.end(), [&](const PreparedImage& image) {
      return in_view(image.volume, landmark.second);
    });
  });
  require(landmarks.empty() || inside >= kLeastInImage, "only ", inside, " of ", landmarks.size(),
          " known landmarks lie in the image, and ", kLeastInImage,
          " is the least; they belong to another image, or to another frame than LPS");
}

/// Landmarks placed on slices are as exact as these are thin: borders are looked for at least this
/// many voxels away.
constexpr double kVoxelsSearched = 3.0;

/// mm, of the image with the thinnest slices.
double thinnest_slice(const std::vector<PreparedImage>& images) {
  double thinnest = kInfinity;
  for (const PreparedImage& image : images)
    thinnest = std::min(thinnest, image.volume.spacing.maxCoeff());
  return thinnest;
}

/// A bone's confidence below which it is looked for twice more, in a narrower search (share of the
/// usual range): from the same start, and from where dark lines inside it lie.
constexpr double kDoubtfulBone = 0.65, kNarrowShare = 2.0 / 3.0;
/// mm, of the places where dark lines lie.
constexpr double kDrawnNoise = 1.0;

double mean_confidence(const std::vector<Body>& bodies) {
  double sum = 0.0;
  for (const Body& body : bodies) sum += quality_of(body).confidence;
  return sum / static_cast<double>(bodies.size());
}

/// Bones of two searches whose mean confidences differ by less are equally well found.
constexpr double kClearlyBetter = 0.01;

/// Takes other bones that are clearly better found on the whole. (The better of each would not fit
/// each other: in one search they keep out of each other.)
void update_best(std::vector<Body>& best, std::vector<Body> others) {
  if (mean_confidence(others) > mean_confidence(best) + kClearlyBetter) best = std::move(others);
}

bool any_doubtful(const std::vector<Body>& bodies) {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& body) { return quality_of(body).confidence < kDoubtfulBone; });
}

}  // namespace

std::vector<Body> Hip::found_by(const std::vector<Resolution>& resolutions, std::vector<Body> bones,
                                const Monitor& monitor) const {
  update_through(bones, resolutions, images_, std::vector<Obstacles>(bones.size()),
                 std::vector<TriMesh>(bones.size()), options_, monitor);
  return bones;
}

std::vector<const shape::StructureModel*> Hip::models_of(
    const std::vector<std::size_t>& numbers) const {
  std::vector<const shape::StructureModel*> models;
  for (const std::size_t s : numbers) models.push_back(models_[s]);
  return models;
}

std::vector<Body> Hip::bones_at(const std::vector<std::size_t>& numbers, const BoneStart& start) {
  const auto& [placed, landmarks] = start;
  const auto models = models_of(numbers);
  std::vector<Body> bones;
  for (std::size_t b = 0; b < models.size(); ++b) {
    bones.push_back(placed_body(*models[b], placed[b]));
    bones.back().prepared = &preparations_[numbers[b]];
    bones.back().reach =
        reach_to_far_end(reach_of(*models[b], landmarks, atlas_), bones.back().points, images_);
    update_any_kind_beyond(preparations_[numbers[b]], bones.back().reach);
  }
  return bones;
}

std::vector<Body> Hip::searched_bones(std::vector<Body> bones, const Monitor& monitor) {
  const double slice = thinnest_slice(images_);
  const double wide = std::max(options_.search_range, kVoxelsSearched * slice);
  choose_contrasts(bones, bone_resolutions(wide).front());
  std::vector<Body> best =
      found_by(bone_resolutions(wide), bones, part_of(monitor, "segment", 0.0, 0.5));
  // too wide a search may take another border for the bone's; in slices thicker than the usual
  // range nothing nearer can be asked for
  const bool thick = slice > options_.search_range;
  if (wide > options_.search_range && !thick)
    update_best(best, found_by(bone_resolutions(options_.search_range), bones,
                               part_of(monitor, "segment", 0.5, 0.75)));
  if (any_doubtful(best) && !thick) {
    auto narrow = bone_resolutions(kNarrowShare * options_.search_range);
    update_best(best, found_by(narrow, bones, part_of(monitor, "segment", 0.75, 0.85)));
    for (std::size_t b = 0; b < bones.size(); ++b) {
      bones[b].fit =
          fit_model(*bones[b].model, drawn_to_cortex(best[b], images_),
                    VecX::Ones(bones[b].points.rows()), kDrawnNoise, &bones[b].prepared->smooth);
      bones[b].points = bones[b].fit.points;
    }
    // without the first, which would take the smooth deformations out again
    narrow.erase(narrow.begin());
    update_best(best, found_by(narrow, bones, part_of(monitor, "segment", 0.85, 1.0)));
  }
  return best;
}

std::vector<BoneStart> Hip::bone_starts(const std::vector<std::size_t>& numbers,
                                        const shape::Landmarks& given, const Monitor& monitor) {
  const auto models = models_of(numbers);
  const auto by_landmarks = [&](const shape::Landmarks& landmarks) {
    return BoneStart{place_by_landmarks(models, landmarks, atlas_, options_.landmark_error),
                     landmarks};
  };
  if (!given.empty()) return {by_landmarks(given)};
  std::vector<BoneStart> starts;
  for (const std::vector<Points>& placed : find_pose(models, images_, options_, monitor).starts) {
    // an atlas of one's own may know few landmarks
    const bool enough = atlas_.landmarks.size() >= kLeastLandmarks;
    starts.push_back(enough ? by_landmarks(landmarks_at(placed, models, atlas_))
                            : BoneStart{placed, {}});
  }
  return starts;
}

void Hip::segment_bones(const shape::Landmarks& given, const Monitor& monitor) {
  std::vector<std::size_t> numbers;
  for (std::size_t s = 0; s < models_.size(); ++s)
    if (is_bone(s)) numbers.push_back(s);
  const std::vector<BoneStart> starts = bone_starts(numbers, given, monitor);
  check_in_image(images_, given);
  const auto n = static_cast<double>(starts.size());
  std::vector<Body> best;
  std::vector<std::string> contrasts;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const auto done = static_cast<double>(k);
    std::vector<Body> bones = searched_bones(
        bones_at(numbers, starts[k]), part_of(monitor, "segment", done / n, (done + 1.0) / n));
    if (k > 0 && mean_confidence(bones) <= mean_confidence(best)) continue;
    best = std::move(bones);
    contrasts.clear();
    for (const PreparedImage& image : images_) contrasts.push_back(image.contrast);
  }
  for (std::size_t i = 0; i < images_.size(); ++i) images_[i].contrast = contrasts[i];
  for (std::size_t b = 0; b < numbers.size(); ++b) bodies_[numbers[b]] = std::move(best[b]);
}

}  // namespace coxa::segment
