#include "landmark_reach.h"

#include <algorithm>

namespace coxa::segment {
namespace {

/// mm. A landmark nearer than this to a bone belongs to it; the centre of a femoral head does.
constexpr double kOwnLandmark = 30.0;

/// mm. Cortex this far from every landmark, at a shaft's end, is as thick as the person's: any kind
/// of profile of the bone may be met there.
constexpr double kOwnKindsReach = 60.0;

/// mm. Landmarks about a hip leave no place of its hip bone farther than 80 mm; beyond this lies a
/// shaft.
constexpr double kFarEnd = 100.0;

bool shows(const std::vector<PreparedImage>& images, const Vec3& p) {
  return std::any_of(images.begin(), images.end(),
                     [&](const PreparedImage& image) { return in_view(image.volume, p); });
}

}  // namespace

VecX reach_to_far_end(VecX reach, const Points& placed, const std::vector<PreparedImage>& images) {
  for (Eigen::Index v = 0; v < reach.size(); ++v) {
    if (reach[v] > kFarEnd && shows(images, placed.row(v).transpose())) return reach;
  }
  return {};
}

VecX reach_of(const shape::StructureModel& model, const shape::Landmarks& given,
              const shape::Atlas& atlas) {
  const Points& points = model.hierarchy.levels.back().points;
  VecX reach;
  for (const auto& [name, place] : given) {
    const auto known = atlas.landmarks.find(name);
    if (known == atlas.landmarks.end()) continue;
    const VecX away = (points.rowwise() - known->second.transpose()).rowwise().norm();
    if (away.minCoeff() > kOwnLandmark) continue;
    reach = reach.size() == 0 ? away : VecX(reach.cwiseMin(away));
  }
  return reach;
}

void update_any_kind_beyond(Preparation& preparation, const VecX& reach) {
  for (auto& [contrast, kinds] : preparation.kinds) {
    const auto any = 1.0 / static_cast<double>(kinds.share.cols());
    for (Eigen::Index v = 0; v < reach.size(); ++v) {
      if (reach[v] > kOwnKindsReach) kinds.share.row(v).setConstant(any);
    }
  }
}

}  // namespace coxa::segment
