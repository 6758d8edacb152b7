#include <coxa/dynamics/particles.h>

#include <coxa/core/error.h>

#include <algorithm>

namespace coxa::dynamics {

void Constraints::add(Index particle, const Mat3& projector, const Vec3& dv) {
  require(particle >= 0, "a constraint names particle ", particle);
  const auto place = std::lower_bound(particles.begin(), particles.end(), particle);
  const auto at = place - particles.begin();
  if (place != particles.end() && *place == particle) {
    allowed[static_cast<std::size_t>(at)] = projector;
    velocity_change[static_cast<std::size_t>(at)] = dv;
    return;
  }
  particles.insert(place, particle);
  allowed.insert(allowed.begin() + at, projector);
  velocity_change.insert(velocity_change.begin() + at, dv);
}

void Constraints::filter(VecX& values) const {
  for (std::size_t k = 0; k < particles.size(); ++k) {
    auto value = values.segment<3>(3 * Eigen::Index{particles[k]});
    value = (allowed[k] * value).eval();
  }
}

}  // namespace coxa::dynamics
