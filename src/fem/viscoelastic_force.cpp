#include <coxa/fem/viscoelastic_force.h>

#include <coxa/core/error.h>

#include <Eigen/LU>

#include <cmath>

#include "element_assembly.h"
#include "mode_tensors.h"
#include "point_blocks.h"

namespace coxa::fem {

/// Internal stresses at the start of the step, and what the step's length makes of them.
struct ViscoelasticForce::State {
  std::vector<Mat3> q;        // per term and point: stress of the term
  std::vector<Mat3> elastic;  // per point: elastic second Piola-Kirchhoff stress
  std::vector<Mat3> past;     // per point: what the past adds to the stress at the end of the step
  double present = 1.0;       // share of the elastic stress at the end of the step
  double h = 0.0;

  struct Factors {
    double decay, growth;  // exp(-h/t), (1 - exp(-h/t)) / (h/t)
  };
  Factors factors(double time) const {
    const double ratio = h / time;
    return {std::exp(-ratio), ratio > 0.0 ? -std::expm1(-ratio) / ratio : 1.0};
  }
};

ViscoelasticForce::ViscoelasticForce(const TetMesh& mesh, std::unique_ptr<const Material> material,
                                     std::vector<PronyTerm> terms, ParticleMap map,
                                     ElasticOptions options)
    : material_(std::move(material)),
      terms_(std::move(terms)),
      tangent_(options.tangent),
      assembly_(std::make_unique<ElementAssembly>(mesh, std::move(map), options.axes)),
      state_(std::make_unique<State>()) {
  COXA_ASSERT(material_ != nullptr);
  double sum = 0.0;
  for (const PronyTerm& term : terms_) {
    require(term.share > 0.0 && term.time > 0.0,
            "a Prony term needs a positive share and time, got ", term.share, " and ", term.time,
            " s");
    sum += term.share;
  }
  require(sum <= 1.0, "the shares of the Prony terms sum to ", sum, "; at most 1 can relax");
  const std::size_t n = assembly_->n_all_points();
  state_->q.assign(n * terms_.size(), Mat3::Zero());
  state_->elastic.assign(n, Mat3::Zero());
  state_->past.assign(n, Mat3::Zero());
}

ViscoelasticForce::~ViscoelasticForce() = default;

void ViscoelasticForce::begin_step(double h) {
  require(h >= 0.0, "a step cannot take ", h, " s");
  State& s = *state_;
  const std::size_t n = s.past.size();
  s.h = h;
  s.present = 1.0;
  std::fill(s.past.begin(), s.past.end(), Mat3::Zero());
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    const auto [decay, growth] = s.factors(terms_[k].time);
    s.present += terms_[k].share * (growth - 1.0);
    for (std::size_t i = 0; i < n; ++i)
      s.past[i] += decay * s.q[k * n + i] - terms_[k].share * growth * s.elastic[i];
  }
}

void ViscoelasticForce::end_step(const VecX& x) {
  State& s = *state_;
  const std::size_t n = s.past.size();
  parallel_for(assembly_->n_elements(), [&](Index e) {
    for (int q = 0; q < assembly_->n_points(); ++q) {
      const std::size_t i = assembly_->point(e, q);
      const Mat3 F = assembly_->gradient_of(x, e, q);
      const Mat3 elastic = F.inverse() * material_->first_piola(F);
      for (std::size_t k = 0; k < terms_.size(); ++k) {
        const auto [decay, growth] = s.factors(terms_[k].time);
        s.q[k * n + i] =
            decay * s.q[k * n + i] + terms_[k].share * growth * (elastic - s.elastic[i]);
      }
      s.elastic[i] = elastic;
    }
  });
  begin_step(0.0);
}

Mat3 ViscoelasticForce::first_piola(const Mat3& F, Index e, int q) const {
  return state_->present * material_->first_piola(F) + F * state_->past[assembly_->point(e, q)];
}

std::vector<std::pair<Index, Index>> ViscoelasticForce::pattern() const {
  return assembly_->pattern();
}

void ViscoelasticForce::add_force(const VecX& x, const VecX&, VecX& force) const {
  assembly_->add_force(
      [&](Index e, int q) { return first_piola(assembly_->gradient_of(x, e, q), e, q); }, force);
}

void ViscoelasticForce::add_jacobian(const VecX& x, const VecX&, double stiffness_factor, double,
                                     solve::BlockMatrix& A) const {
  if (stiffness_factor == 0.0) return;
  assembly_->add_jacobian(
      [&](Index e, int q, double weight, Mat3* blocks) {
        const Mat3& past = state_->past[assembly_->point(e, q)];
        const double factor = stiffness_factor * weight;
        const auto r = assembly_->shape_gradients(e, q);
        material_->add_blocks(assembly_->gradient_of(x, e, q), tangent_, factor * state_->present,
                              r, blocks);
        Mat9 C = Mat9::Zero();
        add_geometric(tangent_ == Tangent::positive ? tensile_part(past) : past, C);
        add_tangent_blocks(C, factor, r, blocks);
      },
      A);
}

double ViscoelasticForce::energy(const VecX& x) const {
  return assembly_->sum([&](Index e, int q) {
    const Mat3 F = assembly_->gradient_of(x, e, q);
    const Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity());
    return state_->present * material_->energy_density(F) +
           E.cwiseProduct(state_->past[assembly_->point(e, q)]).sum();
  });
}

void ViscoelasticForce::set_offsets(const Points& offset) { assembly_->set_offsets(offset); }

Mat3 ViscoelasticForce::cauchy_stress(const VecX& x, Index e) const {
  Mat3 sum = Mat3::Zero();
  double volume = 0.0;
  for (int q = 0; q < assembly_->n_points(); ++q) {
    const Mat3 F = assembly_->gradient_of(x, e, q);
    sum += assembly_->weight(e, q) * cauchy_from(first_piola(F, e, q), F);
    volume += assembly_->weight(e, q);
  }
  return sum / volume;
}

}  // namespace coxa::fem
