#include <coxa/collide/contact_friction.h>

#include <coxa/core/error.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace coxa::collide {

ContactFriction::ContactFriction(double coefficient, double stiffness)
    : coefficient_(coefficient), stiffness_(stiffness) {
  require(coefficient >= 0.0, "coefficient of friction must not be negative, got ", coefficient);
  require(stiffness > 0.0, "tangential stiffness must be positive (MPa/mm), got ", stiffness);
}

void ContactFriction::begin_step(const VecX& x) { start_ = x; }

void ContactFriction::update(const SurfaceContact& contact, const VecX& x) {
  if (start_.size() != x.size()) start_ = x;
  patches_.clear();
  particles_.clear();
  weights_.clear();
  for (const ContactConstraint& constraint : contact.constraints()) {
    const double pressure = contact.pressure(constraint, x);
    if (pressure == 0.0) continue;
    const auto owner = static_cast<std::size_t>(constraint.owner);
    if (left_.size() <= owner) left_.resize(owner + 1, Vec3::Zero());
    const Vec3 normal = constraint.normal.normalized();
    Patch patch{constraint.owner,
                static_cast<Index>(particles_.size()),
                0,
                normal,
                Mat3::Identity() - normal * normal.transpose(),
                constraint.area,
                coefficient_ * pressure,
                Vec3::Zero()};
    patch.traction = patch.tangent * left_[owner];
    for (Index k = constraint.first; k < constraint.last; ++k) {
      particles_.push_back(contact.stencil_particles()[static_cast<std::size_t>(k)]);
      // the stencil is weight times normal
      weights_.push_back(contact.stencil_vectors()[static_cast<std::size_t>(k)].dot(normal));
    }
    patch.last = static_cast<Index>(particles_.size());
    patches_.push_back(patch);
  }
}

void ContactFriction::forget() {
  start_.resize(0);
  left_.clear();
  patches_.clear();
}

void ContactFriction::end_step(const VecX& x) {
  std::vector<Vec3> now(left_.size(), Vec3::Zero());
  for (const Patch& patch : patches_) {
    now[static_cast<std::size_t>(patch.owner)] = traction(patch, x);
  }
  left_ = std::move(now);
}

/// What the traction would be if nothing slid, MPa: against the slip of the slave.
Vec3 ContactFriction::trial(const Patch& patch, const VecX& x) const {
  Vec3 slip = Vec3::Zero();
  for (Index k = patch.first; k < patch.last; ++k) {
    const auto at = static_cast<std::size_t>(k);
    slip +=
        weights_[at] * (x.segment<3>(3 * particles_[at]) - start_.segment<3>(3 * particles_[at]));
  }
  return patch.traction - stiffness_ * patch.tangent * slip;
}

Vec3 ContactFriction::traction(const Patch& patch, const VecX& x) const {
  const Vec3 t = trial(patch, x);
  const double size = t.norm();
  return size <= patch.limit ? t : Vec3(patch.limit / size * t);
}

/// The slope of a constraint's traction with its slip: along the trial traction, where it slides
/// none, and across it.
std::array<ContactFriction::Term, 2> ContactFriction::terms_of(const Patch& patch,
                                                               const VecX& x) const {
  const Vec3 t = trial(patch, x);
  const double size = t.norm(), stuck = stiffness_ * patch.area;
  const Vec3 normal = patch.normal;
  const Vec3 along = size > 0.0 ? Vec3(t / size) : normal.unitOrthogonal();
  const bool slides = size > patch.limit;
  return {{{slides ? 0.0 : stuck, along},
           {slides ? patch.limit / size * stuck : stuck, normal.cross(along)}}};
}

double ContactFriction::energy(const VecX& x) const {
  double sum = 0.0;
  for (const Patch& patch : patches_) {
    const double size = trial(patch, x).norm();
    sum += patch.area / stiffness_ *
           (size <= patch.limit ? 0.5 * size * size : patch.limit * (size - 0.5 * patch.limit));
  }
  return sum;
}

void ContactFriction::add_force(const VecX& x, const VecX& /*v*/, VecX& force) const {
  for (const Patch& patch : patches_) {
    const Vec3 pull = patch.area * traction(patch, x);
    for (Index k = patch.first; k < patch.last; ++k) {
      const auto at = static_cast<std::size_t>(k);
      force.segment<3>(3 * particles_[at]) += weights_[at] * pull;
    }
  }
}

Vec3 ContactFriction::resultant(const VecX& x) const {
  Vec3 sum = Vec3::Zero();
  for (const Patch& patch : patches_) sum += patch.area * traction(patch, x);
  return sum;
}

std::vector<std::pair<Index, Index>> ContactFriction::pattern() const {
  std::vector<std::pair<Index, Index>> blocks;
  for (const Patch& patch : patches_) {
    for (Index i = patch.first; i < patch.last; ++i) {
      for (Index j = patch.first; j < patch.last; ++j) {
        blocks.emplace_back(particles_[static_cast<std::size_t>(i)],
                            particles_[static_cast<std::size_t>(j)]);
      }
    }
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

void ContactFriction::add_jacobian(const VecX& x, const VecX& /*v*/, double stiffness_factor,
                                   double /*damping_factor*/, solve::BlockMatrix& A) const {
  if (stiffness_factor == 0.0) return;
  for (const Patch& patch : patches_) {
    Mat3 K = Mat3::Zero();
    for (const Term& term : terms_of(patch, x))
      K += stiffness_factor * term.stiffness * term.direction * term.direction.transpose();
    for (Index i = patch.first; i < patch.last; ++i) {
      for (Index j = patch.first; j < patch.last; ++j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        A.at(particles_[a], particles_[b]) += weights_[a] * weights_[b] * K;
      }
    }
  }
}

}  // namespace coxa::collide
