#include "hip_tangent.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <Eigen/LU>
#include <cmath>

namespace coxa::joint {
namespace {

constexpr int kMaxIterations = 3000;

}  // namespace

HipTangent::HipTangent(std::vector<bool> free, const HipSystem& system)
    : free_(std::move(free)), compact_(free_.size(), 0) {
  const auto elastic_pattern = system.elastic_pattern();
  full_ = solve::BlockMatrix(static_cast<Index>(free_.size()), elastic_pattern);
  for (std::size_t i = 0; i < free_.size(); ++i) {
    if (!free_[i]) continue;
    compact_[i] = static_cast<Index>(particle_.size());
    particle_.push_back(static_cast<Index>(i));
  }
  std::vector<std::pair<Index, Index>> pattern;
  for (const auto& [i, j] : elastic_pattern) {
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
    if (free_[a] && free_[b]) pattern.emplace_back(compact_[a], compact_[b]);
  }
  elastic_ = solve::BlockMatrix(static_cast<Index>(particle_.size()), pattern);
  source_.resize(elastic_.blocks().size());
  for (Index row = 0; row < elastic_.n(); ++row) {
    const auto begin = elastic_.row_start()[static_cast<std::size_t>(row)];
    const auto end = elastic_.row_start()[static_cast<std::size_t>(row) + 1];
    for (auto slot = begin; slot < end; ++slot) {
      const Index column = elastic_.columns()[static_cast<std::size_t>(slot)];
      source_[static_cast<std::size_t>(slot)] = full_.slot(
          particle_[static_cast<std::size_t>(row)], particle_[static_cast<std::size_t>(column)]);
    }
  }
}

void HipTangent::update_elastic(const HipSystem& system, const VecX& x) {
  full_.set_zero();
  system.add_elastic_jacobian(x, full_);
  patches_.clear();
  for (const fem::MeanDilatation* patches : system.patches()) {
    const fem::PatchTerms terms = patches->patch_terms(x);
    for (std::size_t k = 0; k < terms.stiffness.size(); ++k) {
      const auto first = static_cast<std::size_t>(terms.start[k]);
      add_row(patches_, terms.stiffness[k], &terms.particle[first], &terms.slope[first],
              static_cast<Index>(terms.start[k + 1] - terms.start[k]));
    }
  }
  patches_.index_by_particle(particle_.size());
  parallel_for(static_cast<std::int64_t>(source_.size()), [&](Index slot) {
    const auto s = static_cast<std::size_t>(slot);
    elastic_.blocks()[s] = full_.blocks()[static_cast<std::size_t>(source_[s])];
  });
}

void HipTangent::Terms::clear() {
  rows.clear();
  particle.clear();
  slope.clear();
}

void HipTangent::Terms::index_by_particle(std::size_t n_free) {
  row_force.assign(rows.size(), 0.0);
  use_start.assign(n_free + 1, 0);
  for (const Index i : particle) ++use_start[static_cast<std::size_t>(i) + 1];
  for (std::size_t i = 0; i < n_free; ++i) use_start[i + 1] += use_start[i];
  use_row.resize(particle.size());
  use_slope.resize(particle.size());
  std::vector<Index> next(use_start.begin(), use_start.end() - 1);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (Index k = rows[r].first; k < rows[r].last; ++k) {
      const auto free = static_cast<std::size_t>(particle[static_cast<std::size_t>(k)]);
      const auto at = static_cast<std::size_t>(next[free]++);
      use_row[at] = static_cast<Index>(r);
      use_slope[at] = slope[static_cast<std::size_t>(k)];
    }
  }
}

void HipTangent::Terms::add_diagonal(std::size_t free, Mat3& block) const {
  for (Index u = use_start[free]; u < use_start[free + 1]; ++u) {
    const Vec3& own = use_slope[static_cast<std::size_t>(u)];
    const Row& row = rows[static_cast<std::size_t>(use_row[static_cast<std::size_t>(u)])];
    block += row.stiffness * own * own.transpose();
  }
}

void HipTangent::Terms::update_forces(const VecX& z) const {
  parallel_for(static_cast<std::int64_t>(rows.size()), [&](Index r) {
    const Row& row = rows[static_cast<std::size_t>(r)];
    double closing = 0.0;
    for (Index k = row.first; k < row.last; ++k) {
      const auto at = static_cast<std::size_t>(k);
      closing += slope[at].dot(z.segment<3>(3 * particle[at]));
    }
    row_force[static_cast<std::size_t>(r)] = row.stiffness * closing;
  });
}

Vec3 HipTangent::Terms::force(std::size_t free) const {
  Vec3 sum = Vec3::Zero();
  for (Index u = use_start[free]; u < use_start[free + 1]; ++u) {
    const auto at = static_cast<std::size_t>(u);
    sum += row_force[static_cast<std::size_t>(use_row[at])] * use_slope[at];
  }
  return sum;
}

void HipTangent::add_row(Terms& terms, double stiffness, const Index* particle, const Vec3* slope,
                         Index n) const {
  Terms::Row row{stiffness, static_cast<Index>(terms.particle.size()), 0};
  for (Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(particle[k]);
    if (!free_[i]) continue;
    terms.particle.push_back(compact_[i]);
    terms.slope.push_back(slope[k]);
  }
  row.last = static_cast<Index>(terms.particle.size());
  terms.rows.push_back(row);
}

void HipTangent::update_contact(const HipContact& hip, const VecX& x) {
  contact_.clear();
  hip.for_each_constraint([&](const auto& contact, const auto& constraint) {
    if (contact.pressure(constraint, x) == 0.0) return;
    const auto first = static_cast<std::size_t>(constraint.first);
    add_row(contact_, contact.stiffness(constraint) * constraint.area,
            &contact.stencil_particles()[first], &contact.stencil_vectors()[first],
            constraint.last - constraint.first);
  });
  if (hip.friction()) {
    hip.friction()->for_each_term(
        x, [&](double stiffness, const Index* particle, const Vec3* slope, Index n) {
          add_row(contact_, stiffness, particle, slope, n);
        });
  }
  contact_.index_by_particle(particle_.size());
  update_preconditioner();
}

void HipTangent::update_preconditioner() {
  inverse_diagonal_.resize(particle_.size());
  parallel_for(static_cast<std::int64_t>(particle_.size()), [&](Index i) {
    const auto p = static_cast<std::size_t>(i);
    Mat3 block = elastic_.blocks()[static_cast<std::size_t>(elastic_.slot(i, i))];
    patches_.add_diagonal(p, block);
    contact_.add_diagonal(p, block);
    // a particle that nothing holds in some direction stays where it is in that direction
    block.diagonal().array() += 1e-9 * block.trace() + 1e-12;
    inverse_diagonal_[p] = block.inverse();
  });
}

void HipTangent::multiply(const VecX& z, VecX& y) const {
  patches_.update_forces(z);
  contact_.update_forces(z);
  elastic_.multiply(z, y);
  parallel_for(static_cast<std::int64_t>(particle_.size()), [&](Index i) {
    const auto p = static_cast<std::size_t>(i);
    y.segment<3>(3 * i) += patches_.force(p) + contact_.force(p);
  });
}

VecX HipTangent::preconditioned(const VecX& r) const {
  VecX z(r.size());
  for (std::size_t i = 0; i < inverse_diagonal_.size(); ++i) {
    const auto at = 3 * static_cast<Eigen::Index>(i);
    z.segment<3>(at) = inverse_diagonal_[i] * r.segment<3>(at);
  }
  return z;
}

SolveReport HipTangent::solve(const VecX& residual, double tolerance, VecX& step) const {
  const auto n = static_cast<Eigen::Index>(particle_.size());
  VecX r(3 * n), x = VecX::Zero(3 * n), Ap(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    r.segment<3>(3 * i) = residual.segment<3>(3 * particle_[static_cast<std::size_t>(i)]);
  }
  const double target = tolerance * r.norm();
  SolveReport report;
  VecX z = preconditioned(r), p = z;
  double rz = r.dot(z);
  for (; report.iterations < kMaxIterations && r.norm() > target; ++report.iterations) {
    multiply(p, Ap);
    const double curvature = p.dot(Ap);
    if (!(curvature > 0.0)) {
      // follow the direction of negative curvature once, then let the line search decide
      if (report.iterations == 0) x = p;
      report.reason = "tangent is not positive definite";
      break;
    }
    const double alpha = rz / curvature;
    x += alpha * p;
    r -= alpha * Ap;
    z = preconditioned(r);
    const double next = r.dot(z);
    p = z + (next / rz) * p;
    rz = next;
  }
  report.residual = r.norm();
  report.converged = report.residual <= target;
  step = VecX::Zero(residual.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    step.segment<3>(3 * particle_[static_cast<std::size_t>(i)]) = x.segment<3>(3 * i);
  }
  return report;
}

}  // namespace coxa::joint
