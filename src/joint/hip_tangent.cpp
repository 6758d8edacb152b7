#include "hip_tangent.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/dynamics/system.h>

#include <Eigen/LU>
#include <cmath>

namespace coxa::joint {
namespace {

constexpr int kMaxIterations = 3000;

}  // namespace

HipTangent::HipTangent(std::vector<bool> free, const HipSystem& system)
    : free_(std::move(free)), compact_(free_.size(), 0) {
  const auto elastic_pattern = dynamics::total_pattern(system.elastic());
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
  dynamics::assemble(system.elastic(), x, VecX::Zero(x.size()), 1.0, 0.0, full_);
  patch_terms_.clear();
  for (const fem::MeanDilatation* patches : system.patches()) {
    patches->add_element_jacobian(x, full_);
    patch_terms_.push_back(patches->patch_terms(x));
  }
  parallel_for(static_cast<std::int64_t>(source_.size()), [&](Index slot) {
    const auto s = static_cast<std::size_t>(slot);
    elastic_.blocks()[s] = full_.blocks()[static_cast<std::size_t>(source_[s])];
  });
}

void HipTangent::add_row(double stiffness, const Index* particle, const Vec3* slope, Index n) {
  Row row{stiffness, static_cast<Index>(row_particle_.size()), 0};
  for (Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(particle[k]);
    if (!free_[i]) continue;
    row_particle_.push_back(compact_[i]);
    row_slope_.push_back(slope[k]);
  }
  row.last = static_cast<Index>(row_particle_.size());
  rows_.push_back(row);
}

void HipTangent::update_contact(const HipContact& hip, const VecX& x) {
  rows_.clear();
  row_particle_.clear();
  row_slope_.clear();
  for (const fem::PatchTerms& terms : patch_terms_) {
    for (std::size_t k = 0; k < terms.stiffness.size(); ++k) {
      const auto first = static_cast<std::size_t>(terms.start[k]);
      add_row(terms.stiffness[k], &terms.particle[first], &terms.slope[first],
              static_cast<Index>(terms.start[k + 1] - terms.start[k]));
    }
  }
  hip.for_each_constraint([&](const auto& contact, const auto& constraint) {
    if (contact.pressure(constraint, x) == 0.0) return;
    const auto first = static_cast<std::size_t>(constraint.first);
    add_row(contact.stiffness(constraint) * constraint.area, &contact.stencil_particles()[first],
            &contact.stencil_vectors()[first], constraint.last - constraint.first);
  });
  row_force_.assign(rows_.size(), 0.0);
  index_rows_by_particle();
  update_preconditioner();
}

/// The rows' entries by particle, so that products gather in a fixed order.
void HipTangent::index_rows_by_particle() {
  use_start_.assign(particle_.size() + 1, 0);
  for (const Index i : row_particle_) ++use_start_[static_cast<std::size_t>(i) + 1];
  for (std::size_t i = 0; i < particle_.size(); ++i) use_start_[i + 1] += use_start_[i];
  use_row_.resize(row_particle_.size());
  use_slope_.resize(row_particle_.size());
  std::vector<Index> next(use_start_.begin(), use_start_.end() - 1);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    for (Index k = rows_[r].first; k < rows_[r].last; ++k) {
      const auto particle = static_cast<std::size_t>(row_particle_[static_cast<std::size_t>(k)]);
      const auto at = static_cast<std::size_t>(next[particle]++);
      use_row_[at] = static_cast<Index>(r);
      use_slope_[at] = row_slope_[static_cast<std::size_t>(k)];
    }
  }
}

void HipTangent::update_preconditioner() {
  inverse_diagonal_.resize(particle_.size());
  parallel_for(static_cast<std::int64_t>(particle_.size()), [&](Index i) {
    const auto p = static_cast<std::size_t>(i);
    Mat3 block = elastic_.blocks()[static_cast<std::size_t>(elastic_.slot(i, i))];
    for (Index u = use_start_[p]; u < use_start_[p + 1]; ++u) {
      const Row& row = rows_[static_cast<std::size_t>(use_row_[static_cast<std::size_t>(u)])];
      const Vec3& slope = use_slope_[static_cast<std::size_t>(u)];
      block += row.stiffness * slope * slope.transpose();
    }
    // a particle that nothing holds in some direction stays where it is in that direction
    block.diagonal().array() += 1e-9 * block.trace() + 1e-12;
    inverse_diagonal_[p] = block.inverse();
  });
}

void HipTangent::multiply(const VecX& z, VecX& y) const {
  parallel_for(static_cast<std::int64_t>(rows_.size()), [&](Index r) {
    const Row& row = rows_[static_cast<std::size_t>(r)];
    double closing = 0.0;
    for (Index k = row.first; k < row.last; ++k) {
      closing += row_slope_[static_cast<std::size_t>(k)].dot(
          z.segment<3>(3 * row_particle_[static_cast<std::size_t>(k)]));
    }
    row_force_[static_cast<std::size_t>(r)] = row.stiffness * closing;
  });
  elastic_.multiply(z, y);
  parallel_for(static_cast<std::int64_t>(particle_.size()), [&](Index i) {
    const auto p = static_cast<std::size_t>(i);
    Vec3 sum = Vec3::Zero();
    for (Index u = use_start_[p]; u < use_start_[p + 1]; ++u) {
      const auto at = static_cast<std::size_t>(u);
      sum += row_force_[static_cast<std::size_t>(use_row_[at])] * use_slope_[at];
    }
    y.segment<3>(3 * i) += sum;
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
