#include "equilibrium.h"

#include <coxa/core/error.h>
#include <coxa/dynamics/system.h>
#include <coxa/solve/newton.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "rounds.h"

namespace coxa::joint {
namespace {

// longest move of a node in one Newton step, mm: a fraction of the cartilage's thickness
constexpr double kMaxNodeStep = 0.3;
// linear solves that one elastic tangent serves, over several sub-steps: strains and the femur's
// turn change little meanwhile, contact much
constexpr int kTangentAge = 16;
// linear solves need not be better than this far from equilibrium, nor better than that near it
constexpr double kLoosestLinear = 0.1, kTightestLinear = 1e-3;
// net force left on a cartilage, in residual tolerances: with the usual 2e-4, half of what the
// bones' reactions may be out of balance
constexpr double kImbalance = 2.5;
// Newton's method goes so far below the limit of the residual, which new pairs will raise again
constexpr double kNewtonShare = 0.3, kNewtonShareByHand = 0.6;
// stale pairs make no use of a residual smaller than this share of what they left
constexpr double kStalePairs = 0.03;
// residual tolerance is tightened no further than by this for the sake of the net force
constexpr double kFinestNewton = 0.03;
// while a state settles, nodes of wider gaps than this are left alone, mm
constexpr double kReach = 0.2, kReachByHand = 0.05;
// articular surfaces that face each other are hardly steeper to each other than 17 degrees
constexpr double kSlideByHand = 0.3;
// a state that is only passed through may be so much less exact, one led by hand still less: a
// fiftieth of the joint force is left to the next step
constexpr double kSlackOnTheWay = 20.0, kSlackByHand = 100.0, kOverlapSlack = 10.0;

double slack_of(Exactness exactness) {
  if (exactness == Exactness::result) return 1.0;
  return exactness == Exactness::on_the_way ? kSlackOnTheWay : kSlackByHand;
}

/// How the gap of a constraint changes with the translation.
Vec3 translation_slope(const collide::SurfaceContact& contact,
                       const collide::ContactConstraint& constraint, Index translation) {
  Vec3 slope = Vec3::Zero();
  for (Index k = constraint.first; k < constraint.last; ++k) {
    if (contact.stencil_particles()[static_cast<std::size_t>(k)] == translation) {
      slope += contact.stencil_vectors()[static_cast<std::size_t>(k)];
    }
  }
  return slope;
}

}  // namespace

Equilibrium::Equilibrium(const HipSystem& system, LoadMode mode, const JointOptions& options)
    : system_(system),
      mode_(mode),
      options_(options),
      free_(system.free_particles(mode)),
      elastic_(system),
      tangent_(free_, system) {}

void ElasticState::update(const VecX& x) {
  if (x_.size() == x.size() && x_ == x) return;
  force_ = system_.elastic_force(x, energy_);
  x_ = x;
}

VecX Equilibrium::node_forces(const HipState& state) {
  VecX sum = elastic_.force(state.x);
  state.contact.add_force(state.x, sum);
  return sum;
}

VecX Equilibrium::residual(const HipState& state, const Vec3& force) {
  return residual(state.x, state.contact, force);
}

VecX Equilibrium::residual(const VecX& x, const HipContact& contact, const Vec3& force) {
  VecX sum = elastic_.force(x);
  contact.add_force(x, sum);
  if (mode_ == LoadMode::force) sum.segment<3>(3 * system_.translation()) += force;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    if (!free_[i]) sum.segment<3>(3 * static_cast<Eigen::Index>(i)).setZero();
  }
  return sum;
}

double Equilibrium::reference_force(const HipState& state, const Vec3& force) const {
  constexpr double kLeast = 1.0;  // N: below this a prescribed pose does not press
  return mode_ == LoadMode::force ? force.norm()
                                  : std::max(kLeast, state.contact.force(state.x).norm());
}

SolveReport Equilibrium::relax(HipState& state, const Vec3& force, double tolerance,
                               double reference) {
  const solve::NewtonProblem problem{
      .residual = [&](const VecX& x) { return residual(x, state.contact, force); },
      .step =
          [&](const VecX& x, const VecX& r) {
            if (tangent_age_ == 0 || tangent_age_ > kTangentAge) {
              tangent_.update_elastic(system_, x);
              tangent_age_ = 0;
            }
            ++tangent_age_;
            tangent_.update_contact(state.contact, x);
            const double wanted = 0.3 * tolerance * reference / r.norm();
            VecX step;
            tangent_.solve(r, std::clamp(wanted, kTightestLinear, kLoosestLinear), step);
            return step;
          },
      .energy =
          [&](const VecX& x) {
            const double work =
                mode_ == LoadMode::force ? force.dot(x.segment<3>(3 * system_.translation())) : 0.0;
            return elastic_.energy(x) + state.contact.energy(x) - work;
          }};
  return solve::newton(problem, state.x,
                       {.tolerance = tolerance,
                        .scale = reference,
                        .max_iterations = options_.max_newton_iterations,
                        .max_step = kMaxNodeStep});
}

std::string Equilibrium::touch(HipState& state, const Vec3& direction) const {
  const auto t = 3 * system_.translation();
  double way = kInfinity;
  bool touching = false;
  state.contact.for_each_firm_constraint([&](const auto& contact, const auto& constraint) {
    const double closing =
        -translation_slope(contact, constraint, system_.translation()).dot(direction);
    const double gap = contact.gap(constraint, state.x);
    touching = touching || gap <= 0.0;
    if (closing > 0.1) way = std::min(way, gap / closing);
  });
  if (touching) return "";
  if (way == kInfinity) {
    return "the articular surfaces do not face each other along the joint force: nothing to press "
           "against";
  }
  state.x.segment<3>(t) += (way + 0.01) * direction;
  return "";
}

std::string Equilibrium::seat(HipState& state, const Vec3& force) const {
  constexpr int kMaxRounds = 60;
  constexpr double kMaxMove = 0.5, kSettled = 2e-3;  // mm
  const auto t = 3 * system_.translation();
  state.contact.clear_multipliers();
  state.contact.update_stiffness(system_.foundation_stiffness());
  std::string reason = "rigid seating of the head did not settle";
  for (int round = 0; round < kMaxRounds; ++round) {
    state.contact.update_pairs(state.x);
    // translation alone against the springs that the pairs make
    Vec3 pull = force;
    Mat3 stiffness = Mat3::Zero();
    state.contact.for_each_firm_constraint([&](const auto& contact, const auto& constraint) {
      const double p = contact.pressure(constraint, state.x);
      if (p == 0.0) return;
      const Vec3 slope = translation_slope(contact, constraint, system_.translation());
      pull += p * constraint.area * slope;
      stiffness += contact.stiffness() * constraint.area * slope * slope.transpose();
    });
    const bool apart = stiffness.trace() == 0.0;
    if (system_.ligaments()) {
      pull += system_.ligaments()->pull(state.x);
      stiffness += system_.ligaments()->stiffness(state.x);
    }
    if (apart) {
      const Vec3 before = state.x.segment<3>(t);
      reason = touch(state, force.normalized());
      if (!reason.empty()) break;
      if ((state.x.segment<3>(t) - before).norm() == 0.0) break;
      reason = "rigid seating of the head did not settle";
    } else {
      stiffness.diagonal().array() += 0.02 * stiffness.trace();
      Vec3 move = stiffness.inverse() * pull;
      if (move.norm() > kMaxMove) move *= kMaxMove / move.norm();
      state.x.segment<3>(t) += move;
      if (move.norm() < kSettled) {
        reason.clear();
        break;
      }
    }
    if (state.x.segment<3>(t).norm() > options_.max_translation) {
      reason = join_text("the head leaves the socket: it moved ", state.x.segment<3>(t).norm(),
                         " mm under the joint force, limit ", options_.max_translation, " mm");
      break;
    }
  }
  state.contact.update_stiffness(options_.contact_stiffness);
  return reason;
}

/// Largest net force that the residual leaves on a cartilage or the labrum, N: the bones' reactions
/// differ from the contact force by as much.
double Equilibrium::net_force(const VecX& residual) const {
  Vec3 socket = Vec3::Zero(), head = Vec3::Zero(), labrum = Vec3::Zero();
  for (Index i = 0; i < system_.translation(); ++i) {
    (i < system_.n_acetabular() ? socket : head) += residual.segment<3>(3 * i);
  }
  if (const auto& body = system_.labrum()) {
    for (Index i = 0; i < body->n_nodes(); ++i)
      labrum += residual.segment<3>(3 * (body->first() + i));
  }
  return std::max({socket.norm(), head.norm(), labrum.norm()});
}

Settling Equilibrium::judge(const HipState& state, const Vec3& force, const Limits& limits) {
  Settling settling;
  const double reference = reference_force(state, force);
  const VecX left = residual(state, force);
  settling.residual = left.norm() / reference;
  settling.imbalance = net_force(left) / reference;
  settling.penetration = state.contact.penetration(state.x);
  settling.converged = settling.residual <= limits.residual &&
                       settling.imbalance <= limits.imbalance &&
                       settling.penetration <= limits.penetration;
  return settling;
}

Settling Equilibrium::settle(HipState& state, const Vec3& force, Exactness exactness,
                             const Monitor& monitor) {
  const double slack = slack_of(exactness);
  const Limits limits{
      .residual = slack * options_.residual_tolerance,
      .imbalance = slack * kImbalance * options_.residual_tolerance,
      .penetration = std::min(slack, kOverlapSlack) * options_.penetration_tolerance};
  const bool by_hand = exactness == Exactness::by_hand;
  const double reach = by_hand ? kReachByHand : kReach, slide = by_hand ? kSlideByHand : 1.0;
  const double newton_share = by_hand ? kNewtonShareByHand : kNewtonShare;
  int iterations = 0;
  std::string reason;
  Relaxation relaxation;
  Progress progress;
  // what was stiffened on the way to the state before is slow to change, and may not be needed now
  state.contact.clear_stiffening();
  for (int round = 0;; ++round) {
    monitor.check_cancelled();
    state.contact.update_pairs(state.x, reach, slide);
    Settling settling = judge(state, force, limits);
    settling.iterations = iterations;
    if (settling.converged) {
      // results tell gaps everywhere
      if (exactness == Exactness::result) state.contact.update_pairs(state.x);
      return settling;
    }
    const bool hopeless = progress.stalled(settling.residual, settling.penetration);
    if (hopeless || round == options_.max_contact_updates) {
      settling.reason = join_text("no equilibrium after ", iterations, " Newton steps: residual ",
                                  settling.residual, " of the joint force (limit ", limits.residual,
                                  "), net force ", settling.imbalance, " (limit ", limits.imbalance,
                                  "), penetration ", settling.penetration, " mm (limit ",
                                  limits.penetration, " mm)", reason.empty() ? "" : "; " + reason);
      return settling;
    }
    // multipliers wait until the pairs have nearly found their place
    if (settling.residual <= 100.0 * limits.residual && settling.penetration > limits.penetration) {
      state.contact.update_multipliers(state.x, limits.penetration);
      relaxation = {};
      progress.multipliers_changed();
    }
    const bool only_imbalance =
        settling.residual <= limits.residual && settling.imbalance > limits.imbalance;
    const double nearer = only_imbalance ? limits.imbalance / settling.imbalance : 1.0;
    const double tolerance =
        std::max(newton_share * limits.residual * std::max(nearer, kFinestNewton),
                 kStalePairs * settling.residual);
    const VecX before = state.x;
    const SolveReport newton = relax(state, force, tolerance, reference_force(state, force));
    iterations += newton.iterations;
    if (!newton.converged) tangent_age_ = 0;
    reason = newton.reason;
    // by hand the pairs of one search will do
    const bool taken_as_it_is = by_hand && newton.converged && newton.residual <= limits.residual;
    if (!taken_as_it_is) state.x = relaxation.next(before, state.x);
    const double way = state.x.segment<3>(3 * system_.translation()).norm();
    if (!(way <= options_.max_translation)) {
      settling.reason =
          join_text("the head leaves the socket: it moved ", way,
                    " mm under the joint force, limit ", options_.max_translation, " mm");
      return settling;
    }
    if (taken_as_it_is) {
      settling.converged = true;
      settling.residual = newton.residual;
      settling.iterations = iterations;
      return settling;
    }
  }
}

}  // namespace coxa::joint
