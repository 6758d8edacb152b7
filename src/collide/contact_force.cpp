#include <coxa/collide/surface_contact.h>

#include <coxa/core/error.h>

#include <algorithm>

namespace coxa::collide {

double SurfaceContact::gap(const ContactPair& pair, const VecX& x) const {
  Vec3 sum = Vec3::Zero();
  for (Index k = pair.first; k < pair.last; ++k) {
    sum += stencil_weights_[static_cast<std::size_t>(k)] *
           x.segment<3>(3 * stencil_particles_[static_cast<std::size_t>(k)]);
  }
  return pair.normal.dot(sum) - pair.offset;
}

double SurfaceContact::pressure(const ContactPair& pair, const VecX& x) const {
  const double multiplier = multiplier_[static_cast<std::size_t>(pair.sample)];
  return std::max(0.0, multiplier - options_.stiffness * gap(pair, x));
}

double SurfaceContact::energy(const VecX& x) const {
  double sum = 0.0;
  for (const ContactPair& pair : pairs_) {
    const double p = pressure(pair, x),
                 multiplier = multiplier_[static_cast<std::size_t>(pair.sample)];
    sum += 0.5 * pair.area / options_.stiffness * (p * p - multiplier * multiplier);
  }
  return sum;
}

void SurfaceContact::add_force(const VecX& x, const VecX& /*v*/, VecX& force) const {
  for (const ContactPair& pair : pairs_) {
    const double p = pressure(pair, x);
    if (p == 0.0) continue;
    const Vec3 push = p * pair.area * pair.normal;
    for (Index k = pair.first; k < pair.last; ++k) {
      force.segment<3>(3 * stencil_particles_[static_cast<std::size_t>(k)]) +=
          stencil_weights_[static_cast<std::size_t>(k)] * push;
    }
  }
}

std::vector<std::pair<Index, Index>> SurfaceContact::pattern() const {
  std::vector<std::pair<Index, Index>> blocks;
  if (!other_) {
    // the obstacle is rigid: only particles of one slave triangle meet, whatever the pairs are
    for (Index t = 0; t < slave_.n_triangles(); ++t) {
      std::vector<Index> members;
      for (int k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(slave_.triangles(t, k));
        members.insert(members.end(), slave_.particle.begin() + slave_.row_start[v],
                       slave_.particle.begin() + slave_.row_start[v + 1]);
      }
      for (const Index i : members) {
        for (const Index j : members) blocks.emplace_back(i, j);
      }
    }
  } else {
    for (const ContactPair& pair : pairs_) {
      for (Index i = pair.first; i < pair.last; ++i) {
        for (Index j = pair.first; j < pair.last; ++j) {
          blocks.emplace_back(stencil_particles_[static_cast<std::size_t>(i)],
                              stencil_particles_[static_cast<std::size_t>(j)]);
        }
      }
    }
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

void SurfaceContact::add_jacobian(const VecX& x, const VecX& /*v*/, double stiffness_factor,
                                  double /*damping_factor*/, solve::BlockMatrix& A) const {
  for (const ContactPair& pair : pairs_) {
    if (pressure(pair, x) == 0.0) continue;
    const Mat3 block =
        stiffness_factor * options_.stiffness * pair.area * pair.normal * pair.normal.transpose();
    for (Index i = pair.first; i < pair.last; ++i) {
      for (Index j = pair.first; j < pair.last; ++j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        A.at(stencil_particles_[a], stencil_particles_[b]) +=
            stencil_weights_[a] * stencil_weights_[b] * block;
      }
    }
  }
}

double SurfaceContact::update_multipliers(const VecX& x) {
  double penetration = 0.0;
  for (const ContactPair& pair : pairs_) {
    penetration = std::max(penetration, -gap(pair, x));
    multiplier_[static_cast<std::size_t>(pair.sample)] = pressure(pair, x);
  }
  return penetration;
}

void SurfaceContact::clear_multipliers() { std::fill(multiplier_.begin(), multiplier_.end(), 0.0); }

void SurfaceContact::update_stiffness(double stiffness) {
  require(stiffness > 0.0, "contact stiffness must be positive (MPa/mm), got ", stiffness);
  options_.stiffness = stiffness;
}

std::vector<ContactSample> SurfaceContact::samples(const VecX& x) const {
  std::vector<ContactSample> states = samples_;
  const Points points = surface_points(slave_, x);
  for (ContactSample& state : states) {
    for (int k = 0; k < 3; ++k) {
      state.point +=
          state.barycentric[k] * points.row(slave_.triangles(state.triangle, k)).transpose();
    }
  }
  for (const ContactPair& pair : pairs_) {
    ContactSample& state = states[static_cast<std::size_t>(pair.sample)];
    state.normal = pair.normal;
    state.gap = gap(pair, x);
    state.pressure = pressure(pair, x);
  }
  return states;
}

}  // namespace coxa::collide
