#include <coxa/segment/placement.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/geom/thin_plate_spline.h>
#include <coxa/geom/triangle_tree.h>

#include <algorithm>

#include <cmath>
#include <string_view>

namespace coxa::segment {
namespace {

/// Bending stiffness of the spline for each mm of landmark error: a landmark 3 mm off among ten
/// about a hip then moves the surface between its neighbours by less than that.
constexpr double kSmoothnessPerError = 30.0;
/// Adults differ in size by far less than this factor from the mean hip.
constexpr double kLargestScale = 1.5;
/// mm. Landmarks of a real hip fit the mean hip's within 5 to 10; an interchanged pair misses by
/// more.
constexpr double kLargestMisfit = 25.0;
/// rad. Nobody lies turned so far from the frame of the atlas: head, back and left are LPS'.
constexpr double kLargestTurn = radians(90.0);
/// mm. A landmark this deep in a bone is the centre of a round end; another bone this near shares
/// it as its socket.
constexpr double kJointDepth = 14.0;
constexpr double kJointReach = 35.0;
/// A mirror image that fits this many times better is the other side.
constexpr double kMirrorRatio = 2.0;

struct Matched {
  Points atlas, image;
};

Matched match_names(const shape::Landmarks& landmarks, const shape::Atlas& atlas) {
  Matched matched{Points(landmarks.size(), 3), Points(landmarks.size(), 3)};
  Index n = 0;
  for (const auto& [name, position] : landmarks) {
    const auto known = atlas.landmarks.find(name);
    if (known == atlas.landmarks.end()) continue;
    matched.atlas.row(n) = known->second.transpose();
    matched.image.row(n++) = position.transpose();
  }
  matched.atlas.conservativeResize(n, 3);
  matched.image.conservativeResize(n, 3);
  return matched;
}

double misfit(const Points& from, const Points& to, const Similarity& s) {
  const Points off = transformed(s.scale * from, s.X) - to;
  return std::sqrt(off.rowwise().squaredNorm().mean());
}

std::string known_names(const shape::Atlas& atlas) {
  std::string text;
  for (const auto& [name, position] : atlas.landmarks) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void check_plausible(const Matched& matched) {
  const Similarity fit = fit_similarity(matched.atlas, matched.image);
  const Points flipped = mirrored(matched.image);
  const double here = misfit(matched.atlas, matched.image, fit);
  const double there = misfit(matched.atlas, flipped, fit_similarity(matched.atlas, flipped));
  require(there * kMirrorRatio > here,
          "the landmarks look like those of the other hip: as its mirror "
          "image they fit the atlas to ",
          there, " mm, as given to ", here, " mm; check --side");
  require(fit.scale < kLargestScale && fit.scale > 1.0 / kLargestScale,
          "the landmarks describe a hip ", fit.scale, " times the size of the atlas (limit ",
          kLargestScale, "); are they in mm?");
  const double turn = rotation_vector(fit.X.R).norm();
  require(turn < kLargestTurn, "the landmarks describe a hip turned by ", degrees(turn),
          " degrees (limit ", degrees(kLargestTurn),
          "); the image's axes may be wrong in its header");
  require(here <= kLargestMisfit, "the landmarks miss the atlas' by ", here,
          " mm on average (limit ", kLargestMisfit,
          "); two names may be interchanged, or the frame is not LPS");
}

/// Rows of the landmarks that belong to each bone.
std::vector<std::vector<Index>> owned_landmarks(
    const std::vector<const shape::StructureModel*>& bones, const Points& landmarks) {
  std::vector<TriangleTree> trees;
  for (const shape::StructureModel* bone : bones) {
    const TriMesh mean = dual_surface(bone->hierarchy.levels.back());
    trees.emplace_back(mean.points, mean.triangles);
  }
  std::vector<std::vector<Index>> owned(bones.size());
  for (Index row = 0; row < landmarks.rows(); ++row) {
    std::vector<double> distance;
    for (const TriangleTree& tree : trees) {
      distance.push_back(tree.signed_distance(landmarks.row(row).transpose()));
    }
    const double nearest = *std::min_element(distance.begin(), distance.end());
    const double reach = nearest < -kJointDepth ? kJointReach : std::max(nearest, 0.0);
    for (std::size_t b = 0; b < bones.size(); ++b) {
      if (distance[b] <= reach) owned[b].push_back(row);
    }
  }
  return owned;
}

/// Similarity of the rows given, or of all where they are too few to fix a pose.
Similarity fit_rows(const Matched& matched, const std::vector<Index>& rows) {
  if (rows.size() < 3) return fit_similarity(matched.atlas, matched.image);
  Points a(rows.size(), 3), b(rows.size(), 3);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    a.row(static_cast<Index>(i)) = matched.atlas.row(rows[i]);
    b.row(static_cast<Index>(i)) = matched.image.row(rows[i]);
  }
  // size is one number for the whole hip: the few landmarks of one bone would make it noisy
  const double scale = fit_similarity(matched.atlas, matched.image).scale;
  return {scale, fit_rigid(scale * a, b)};
}

}  // namespace

Volume mirrored(const Volume& volume) {
  Volume out = volume;
  out.origin.x() = -out.origin.x();
  out.direction.row(0) = -out.direction.row(0);
  return out;
}

Points mirrored(const Points& points) {
  Points out = points;
  out.col(0) = -out.col(0);
  return out;
}

shape::Landmarks mirrored(const shape::Landmarks& landmarks) {
  shape::Landmarks out = landmarks;
  for (auto& [name, position] : out) position.x() = -position.x();
  return out;
}

shape::Landmarks landmarks_of_side(const shape::Landmarks& given, const shape::Atlas& atlas,
                                   Side side) {
  constexpr std::string_view kSuffix[2] = {"_left", "_right"};
  const std::size_t own = side == Side::left ? 0 : 1;
  shape::Landmarks ours;
  int others = 0;
  for (const auto& [name, position] : given) {
    std::string bare = name;
    bool other = false;
    for (std::size_t s = 0; s < 2; ++s) {
      if (!name.ends_with(kSuffix[s])) continue;
      bare = name.substr(0, name.size() - kSuffix[s].size());
      other = s != own;
    }
    if (!atlas.landmarks.contains(bare)) continue;
    if (other)
      ++others;
    else
      ours[bare] = position;
  }
  require(!ours.empty() || others == 0, "all ", others, " known landmarks belong to the ",
          own == 0 ? "right" : "left", " hip, but the ", own == 0 ? "left" : "right",
          " one is to be segmented");
  return ours;
}

std::vector<Points> place_by_landmarks(const std::vector<const shape::StructureModel*>& bones,
                                       const shape::Landmarks& landmarks, const shape::Atlas& atlas,
                                       double landmark_error) {
  const Matched matched = match_names(landmarks, atlas);
  const auto n = static_cast<Index>(matched.atlas.rows());
  require(matched.atlas.rows() >= static_cast<Eigen::Index>(kLeastLandmarks),
          "segmentation needs at least ", kLeastLandmarks, " landmarks that the atlas knows, got ",
          n, "; it knows ", known_names(atlas));
  check_plausible(matched);

  const std::vector<std::vector<Index>> owned = owned_landmarks(bones, matched.atlas);
  std::vector<Similarity> poses;
  Points from = matched.atlas;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    poses.push_back(fit_rows(matched, owned[b]));
    for (const Index row : owned[b]) {
      from.row(row) = transformed(poses[b].scale * matched.atlas.row(row), poses[b].X);
    }
  }
  const ThinPlateSpline rest(from, matched.image, kSmoothnessPerError * landmark_error);
  std::vector<Points> placed;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const Points& mean = bones[b]->hierarchy.levels.back().points;
    placed.push_back(rest(transformed(poses[b].scale * mean, poses[b].X)));
  }
  return placed;
}

}  // namespace coxa::segment
