#pragma once

#include <coxa/segment/body.h>
#include <coxa/segment/profile_search.h>
#include <coxa/shape/atlas.h>

#include <vector>

namespace coxa::segment {

/// From every finest vertex of the mean to the nearest landmark of those given that belongs to the
/// bone, mm; empty where none does.
VecX reach_of(const shape::StructureModel& model, const shape::Landmarks& given,
              const shape::Atlas& atlas);

/// The same where some place that an image shows is far from all landmarks; else empty: the bone
/// has no far end to be found from near to far.
VecX reach_to_far_end(VecX reach, const Points& placed, const std::vector<PreparedImage>& images);

/// Lets any kind of profile of the bone count at vertices far from every landmark.
void update_any_kind_beyond(Preparation& preparation, const VecX& reach);

}  // namespace coxa::segment
