#include "labrum_figures.h"

#include <coxa/fem/results.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "frame_figures.h"

namespace coxa::joint {
namespace {

/// Pressures of the labrum's nodes, peak and area: every node presses with the area around it.
void fill_pressure(FrameResult& frame, const LabrumBody& body, const HipContact& hip,
                   const VecX& x) {
  frame.labrum_pressure = VecX::Zero(body.n_nodes());
  VecX area = VecX::Zero(body.n_nodes());
  hip.for_each_labrum([&](const collide::SurfaceContact& contact) {
    for (const collide::ContactConstraint& constraint : contact.constraints()) {
      const double pressure = contact.pressure(constraint, x);
      const Index node =
          contact.slave().particle[static_cast<std::size_t>(constraint.owner)] - body.first();
      frame.labrum_pressure[node] += pressure;
      if (pressure > 0.0) area[node] = std::max(area[node], constraint.area);
    }
  });
  std::vector<std::pair<double, double>> pressing;  // pressure, area
  for (Index i = 0; i < body.n_nodes(); ++i) {
    if (area[i] > 0.0) pressing.emplace_back(frame.labrum_pressure[i], area[i]);
  }
  frame.labrum.contact_area = area.sum();
  frame.labrum.peak_pressure_p99 = weighted_percentile(std::move(pressing), 0.99);
}

void fill_strain(LabrumFigures& labrum, const LabrumBody& body, const VecX& x) {
  const fem::ElasticForce& elasticity = body.elasticity().by_element();
  const VecX volumes = elasticity.volumes();
  std::vector<std::pair<double, double>> strains;  // effective strain, volume
  double sum = 0.0;
  for (Index e = 0; e < elasticity.n_elements(); ++e) {
    const Mat3 F = elasticity.deformation_gradient(x, e);
    const double strain = fem::effective_strain(F);
    sum += strain * volumes[e];
    strains.emplace_back(strain, volumes[e]);
  }
  labrum.strain = sum / volumes.sum();
  labrum.peak_strain_p99 = weighted_percentile(std::move(strains), 0.99);
}

}  // namespace

void update_labrum_figures(FrameResult& frame, const JointModel& model, const LabrumBody& body,
                           const HipState& state) {
  frame.labrum_displacement.resize(body.n_nodes(), 3);
  for (Index i = 0; i < body.n_nodes(); ++i) {
    frame.labrum_displacement.row(i) =
        state.x.segment<3>(3 * (body.first() + i)).transpose() - model.labrum_body.points.row(i);
  }
  fill_pressure(frame, body, state.contact, state.x);
  fill_strain(frame.labrum, body, state.x);
  const double all = frame.balance.contact_force.norm();
  frame.labrum.force_share = all > 0.0 ? frame.balance.force_on_labrum.norm() / all : 0.0;
}

}  // namespace coxa::joint
