#include <coxa/collide/surface_contact.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <span>

namespace coxa::collide {
namespace {

// a constraint whose overlap falls slower than this from update to update is made stiffer by this,
// up to that
constexpr double kSlowShare = 0.5, kStiffening = 4.0, kMostStiffening = 1024.0;

}  // namespace

double SurfaceContact::gap(const ContactConstraint& constraint, const VecX& x) const {
  double sum = 0.0;
  for (Index k = constraint.first; k < constraint.last; ++k) {
    const auto at = static_cast<std::size_t>(k);
    sum += stencil_vectors_[at].dot(x.segment<3>(3 * stencil_particles_[at]));
  }
  return sum - constraint.offset;
}

double SurfaceContact::pressure(const ContactConstraint& constraint, const VecX& x) const {
  const double multiplier = multiplier_[static_cast<std::size_t>(constraint.owner)];
  return std::max(0.0, multiplier - stiffness(constraint) * gap(constraint, x));
}

double SurfaceContact::energy(const VecX& x) const {
  double sum = 0.0;
  for (const ContactConstraint& constraint : constraints_) {
    const double p = pressure(constraint, x),
                 multiplier = multiplier_[static_cast<std::size_t>(constraint.owner)];
    sum += 0.5 * constraint.area / stiffness(constraint) * (p * p - multiplier * multiplier);
  }
  return sum;
}

void SurfaceContact::add_force(const VecX& x, const VecX& /*v*/, VecX& force) const {
  for (const ContactConstraint& constraint : constraints_) {
    const double p = pressure(constraint, x);
    if (p == 0.0) continue;
    const double push = p * constraint.area;
    for (Index k = constraint.first; k < constraint.last; ++k) {
      force.segment<3>(3 * stencil_particles_[static_cast<std::size_t>(k)]) +=
          push * stencil_vectors_[static_cast<std::size_t>(k)];
    }
  }
}

/// Particles that a constraint against a rigid obstacle can join, whatever the pairs are.
std::vector<std::vector<Index>> SurfaceContact::slave_groups() const {
  const bool pointwise = options_.rule == ContactRule::pointwise;
  std::vector<std::vector<Index>> groups(
      static_cast<std::size_t>(pointwise ? slave_.n_triangles() : slave_.n_vertices()));
  for (Index t = 0; t < slave_.n_triangles(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto v = static_cast<std::size_t>(slave_.triangles(t, corner));
      const auto first = slave_.particle.begin() + slave_.row_start[v];
      const auto last = slave_.particle.begin() + slave_.row_start[v + 1];
      for (int k = 0; k < 3; ++k) {
        const Index group = pointwise ? t : slave_.triangles(t, k);
        auto& members = groups[static_cast<std::size_t>(group)];
        members.insert(members.end(), first, last);
        if (pointwise) break;
      }
    }
  }
  for (std::vector<Index>& members : groups) {
    std::sort(members.begin(), members.end());
    members.erase(std::unique(members.begin(), members.end()), members.end());
  }
  return groups;
}

std::vector<std::pair<Index, Index>> SurfaceContact::pattern() const {
  std::vector<std::pair<Index, Index>> blocks;
  const auto append_all_pairs = [&](std::span<const Index> members) {
    for (const Index i : members) {
      for (const Index j : members) blocks.emplace_back(i, j);
    }
  };
  if (other_) {
    for (const ContactConstraint& constraint : constraints_) {
      append_all_pairs({stencil_particles_.data() + constraint.first,
                        stencil_particles_.data() + constraint.last});
    }
  } else {
    for (const std::vector<Index>& members : slave_groups()) append_all_pairs(members);
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

void SurfaceContact::add_jacobian(const VecX& x, const VecX& /*v*/, double stiffness_factor,
                                  double /*damping_factor*/, solve::BlockMatrix& A) const {
  for (const ContactConstraint& constraint : constraints_) {
    if (pressure(constraint, x) == 0.0) continue;
    const double factor = stiffness_factor * stiffness(constraint) * constraint.area;
    for (Index i = constraint.first; i < constraint.last; ++i) {
      for (Index j = constraint.first; j < constraint.last; ++j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        A.at(stencil_particles_[a], stencil_particles_[b]) +=
            factor * stencil_vectors_[a] * stencil_vectors_[b].transpose();
      }
    }
  }
}

double SurfaceContact::update_multipliers(const VecX& x, double tolerance) {
  double penetration = 0.0;
  for (const ContactConstraint& constraint : constraints_) {
    const auto owner = static_cast<std::size_t>(constraint.owner);
    const double overlap = -gap(constraint, x);
    penetration = std::max(penetration, overlap);
    multiplier_[owner] = pressure(constraint, x);
    const bool slow = overlap_[owner] > 0.0 && overlap > kSlowShare * overlap_[owner];
    if (slow && overlap > tolerance) {
      stiffening_[owner] = std::min(kMostStiffening, kStiffening * stiffening_[owner]);
    }
    overlap_[owner] = overlap;
  }
  return penetration;
}

void SurfaceContact::clear_multipliers() {
  std::fill(multiplier_.begin(), multiplier_.end(), 0.0);
  clear_stiffening();
}

void SurfaceContact::clear_stiffening() {
  std::fill(stiffening_.begin(), stiffening_.end(), 1.0);
  std::fill(overlap_.begin(), overlap_.end(), 0.0);
}

void SurfaceContact::update_stiffness(double stiffness) {
  require(stiffness > 0.0, "contact stiffness must be positive (MPa/mm), got ", stiffness);
  options_.stiffness = stiffness;
}

std::vector<ContactSample> SurfaceContact::samples(const VecX& x) const {
  std::vector<ContactSample> states = samples_;
  const Points points = surface_points(slave_, x);
  const Points other_points = other_ ? surface_points(*other_, x) : other_mesh_.points;
  for (ContactSample& state : states) {
    for (int k = 0; k < 3; ++k) {
      state.point +=
          state.barycentric[k] * points.row(slave_.triangles(state.triangle, k)).transpose();
    }
  }
  VecX of_owner = VecX::Zero(static_cast<Eigen::Index>(multiplier_.size()));
  for (const ContactConstraint& constraint : constraints_) {
    of_owner[constraint.owner] = pressure(constraint, x);
  }
  for (const ContactPair& pair : pairs_) {
    ContactSample& state = states[static_cast<std::size_t>(pair.sample)];
    state.normal = pair.normal;
    state.gap = pair.normal.dot(state.point - other_point(pair, other_points)) - pair.offset;
    if (options_.rule == ContactRule::pointwise) {
      state.pressure = of_owner[pair.sample];
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      state.pressure += state.barycentric[k] * of_owner[slave_.triangles(state.triangle, k)];
    }
  }
  return states;
}

}  // namespace coxa::collide
