#include <coxa/dynamics/system.h>

#include <coxa/core/error.h>

#include <cmath>

namespace coxa::dynamics {

std::vector<std::pair<Index, Index>> total_pattern(const std::vector<const Force*>& forces) {
  std::vector<std::pair<Index, Index>> pairs;
  for (const Force* force : forces) {
    const auto part = force->pattern();
    pairs.insert(pairs.end(), part.begin(), part.end());
  }
  return pairs;
}

VecX total_force(const std::vector<const Force*>& forces, const VecX& x, const VecX& v) {
  VecX sum = VecX::Zero(x.size());
  for (const Force* force : forces) force->add_force(x, v, sum);
  return sum;
}

double total_energy(const std::vector<const Force*>& forces, const VecX& x) {
  double sum = 0.0;
  for (const Force* force : forces) sum += force->energy(x);
  return sum;
}

void assemble(const std::vector<const Force*>& forces, const VecX& x, const VecX& v,
              double stiffness_factor, double damping_factor, solve::BlockMatrix& A) {
  A.set_zero();
  for (const Force* force : forces) force->add_jacobian(x, v, stiffness_factor, damping_factor, A);
}

double kinetic_energy(const Particles& particles) {
  double sum = 0.0;
  for (Index i = 0; i < particles.n(); ++i)
    sum += 0.5 * particles.mass[i] * particles.v.segment<3>(3 * Eigen::Index{i}).squaredNorm();
  return sum;
}

void update_constrained(const Constraints& constraints, solve::BlockMatrix& A) {
  // where each row stands in the list of constraints; `none` where it does not
  const std::size_t none = constraints.particles.size();
  std::vector<std::size_t> place(static_cast<std::size_t>(A.n()), none);
  for (std::size_t k = 0; k < none; ++k)
    place[static_cast<std::size_t>(constraints.particles[k])] = k;

  for (Index i = 0; i < A.n(); ++i) {
    const std::size_t row = static_cast<std::size_t>(i);
    for (auto s = A.row_start()[row]; s < A.row_start()[row + 1]; ++s) {
      const Index j = A.columns()[static_cast<std::size_t>(s)];
      Mat3& block = A.blocks()[static_cast<std::size_t>(s)];
      const double size = std::abs(block.trace()) / 3.0;
      const std::size_t column_place = place[static_cast<std::size_t>(j)];
      if (place[row] != none) block = (constraints.allowed[place[row]] * block).eval();
      if (column_place != none) block = (block * constraints.allowed[column_place]).eval();
      if (i == j && place[row] != none)
        block += (size > 0.0 ? size : 1.0) * (Mat3::Identity() - constraints.allowed[place[row]]);
    }
  }
}

void check(const Particles& particles) {
  const Eigen::Index size = 3 * Eigen::Index{particles.n()};
  require(particles.x.size() == size && particles.v.size() == size,
          "particles: ", particles.mass.size(), " masses need ", size,
          " positions and velocities, got ", particles.x.size(), " and ", particles.v.size());
  for (Index i = 0; i < particles.n(); ++i)
    require(particles.mass[i] > 0.0 && std::isfinite(particles.mass[i]), "particle ", i,
            " has mass ", particles.mass[i], ", which must be positive and finite");
}

}  // namespace coxa::dynamics
