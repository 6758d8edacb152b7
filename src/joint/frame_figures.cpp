#include "frame_figures.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/tet_quality.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>

#include "labrum_figures.h"

namespace coxa::joint {
namespace {

constexpr double kPatchArea = 5.0;  // mm²

void fill_contact(FrameResult& frame, const std::vector<collide::ContactSample>& samples,
                  const std::vector<collide::ContactSample>& touching, const ClockFace& clock) {
  ContactFigures& contact = frame.contact;
  double total_area = 0.0, total_force = 0.0;
  Vec3 weighted = Vec3::Zero();
  for (const collide::ContactSample& sample : samples) {
    total_area += sample.area;
    if (sample.gap < 0.0) contact.deepest_sample = std::max(contact.deepest_sample, -sample.gap);
    if (sample.pressure == 0.0) continue;
    total_force += sample.pressure * sample.area;
    weighted += sample.pressure * sample.area * sample.point;
  }
  for (const collide::ContactSample& sample : touching) contact.contact_area += sample.area;
  contact.peak_pressure_p99 = pressure_percentile(touching, 0.99);
  contact.peak_pressure_p95 = pressure_percentile(touching, 0.95);
  contact.contact_share = contact.contact_area / total_area;
  if (contact.contact_area > 0.0) {
    contact.mean_pressure = total_force / contact.contact_area;
    contact.centre_of_pressure = weighted / total_force;
    contact.centre_hour = clock.hour(contact.centre_of_pressure);
  }
}

/// Pressures and gaps of the socket's nodes: means of the samples around them, weighted by their
/// share.
void fill_socket_nodes(FrameResult& frame, const collide::SurfaceContact& contact,
                       const std::vector<collide::ContactSample>& samples, Index n) {
  VecX weight = VecX::Zero(n), gap_weight = VecX::Zero(n), gap = VecX::Zero(n);
  frame.acetabular_pressure = VecX::Zero(n);
  for (const collide::ContactSample& sample : samples) {
    for (int k = 0; k < 3; ++k) {
      const Index vertex = contact.slave().triangles(sample.triangle, k);
      const Index node = contact.slave().particle[static_cast<std::size_t>(vertex)];
      const double share = sample.barycentric[k] * sample.area;
      weight[node] += share;
      frame.acetabular_pressure[node] += share * sample.pressure;
      if (std::isnan(sample.gap)) continue;
      gap_weight[node] += share;
      gap[node] += share * sample.gap;
    }
  }
  frame.acetabular_gap = VecX::Constant(n, kNaN);
  for (Index i = 0; i < n; ++i) {
    if (weight[i] > 0.0) frame.acetabular_pressure[i] /= weight[i];
    if (gap_weight[i] > 0.0) frame.acetabular_gap[i] = gap[i] / gap_weight[i];
  }
}

/// Adds what bare femur presses with on the socket's nodes.
void add_bare_femur(FrameResult& frame, const HipContact& hip, const VecX& x) {
  if (!hip.femur()) return;
  for (const collide::ContactConstraint& constraint : hip.femur()->constraints()) {
    const auto vertex = static_cast<std::size_t>(constraint.owner);
    frame.acetabular_pressure[hip.femur()->slave().particle[vertex]] +=
        hip.femur()->pressure(constraint, x);
  }
}

/// Pressures of the head's nodes: the forces they receive over the area around them.
void fill_head_nodes(FrameResult& frame, const JointModel& model, const HipSystem& system,
                     const HipState& state) {
  const Index n = system.n_femoral();
  VecX force = VecX::Zero(n), area = VecX::Zero(n);
  state.contact.for_each_constraint([&](const auto& contact, const auto& constraint) {
    const double push = contact.pressure(constraint, state.x) * constraint.area;
    if (push == 0.0) return;
    for (Index k = constraint.first; k < constraint.last; ++k) {
      const Index particle = contact.stencil_particles()[static_cast<std::size_t>(k)];
      if (particle < system.n_acetabular() || particle >= system.translation()) continue;
      force[particle - system.n_acetabular()] +=
          push * contact.stencil_vectors()[static_cast<std::size_t>(k)].norm();
    }
  });
  TriMesh articular{Points(n, 3), facets_with(model.femoral_cartilage, FacetTag::articular_side)};
  for (Index i = 0; i < n; ++i) {
    articular.points.row(i) = state.x.segment<3>(3 * (system.n_acetabular() + i)).transpose();
  }
  const VecX areas = triangle_areas(articular);
  for (Index f = 0; f < articular.n_triangles(); ++f) {
    for (int k = 0; k < 3; ++k) area[articular.triangles(f, k)] += areas[f] / 3.0;
  }
  frame.femoral_pressure = VecX::Zero(n);
  for (Index i = 0; i < n; ++i) {
    if (area[i] > 0.0) frame.femoral_pressure[i] = std::max(0.0, force[i] / area[i]);
  }
}

void fill_displacements(FrameResult& frame, const JointModel& model, const HipSystem& system,
                        const HipState& state) {
  frame.acetabular_displacement.resize(system.n_acetabular(), 3);
  frame.femoral_displacement.resize(system.n_femoral(), 3);
  const Vec3 found = state.x.segment<3>(3 * system.translation());
  for (Index i = 0; i < system.n_acetabular(); ++i) {
    frame.acetabular_displacement.row(i) =
        state.x.segment<3>(3 * i).transpose() - model.acetabular_cartilage.points.row(i);
  }
  for (Index i = 0; i < system.n_femoral(); ++i) {
    const Vec3 now = state.x.segment<3>(3 * (system.n_acetabular() + i)) + found;
    const Vec3 moved = frame.X_II * Vec3(model.femoral_cartilage.points.row(i));
    frame.femoral_displacement.row(i) = (now - moved).transpose();
  }
}

/// What sectors average, of every socket element: effective strain and least principal strain
/// (Green).
struct ElementStrains {
  VecX effective, least;
};

ElementStrains element_strains(const fem::ElasticForce& elasticity, const VecX& x) {
  ElementStrains strains{VecX(elasticity.n_elements()), VecX(elasticity.n_elements())};
  parallel_for(elasticity.n_elements(), [&](Index e) {
    const Mat3 F = elasticity.deformation_gradient(x, e);
    const Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity());
    const Mat3 deviator = E - E.trace() / 3.0 * Mat3::Identity();
    strains.effective[e] = std::sqrt(2.0 / 3.0) * deviator.norm();
    strains.least[e] = Eigen::SelfAdjointEigenSolver<Mat3>()
                           .computeDirect(E, Eigen::EigenvaluesOnly)
                           .eigenvalues()[0];
  });
  return strains;
}

/// Regions are two hours wide, the first around twelve.
std::size_t region_of(double hour) { return static_cast<std::size_t>((hour + 1.0) / 2.0) % 6; }
std::size_t sector_of(double hour) { return static_cast<std::size_t>(ClockFace::sector(hour)); }

template <std::size_t N, class PartOf>
void fill_sectors(std::array<SectorFigures, N>& sectors, const SocketElements& elements,
                  const ElementStrains& strains, const std::vector<collide::ContactSample>& samples,
                  const VecX& sample_hours, const PartOf& part_of) {
  std::array<double, N> strain{}, compression{}, area{}, force{};
  for (Eigen::Index t = 0; t < elements.hour.size(); ++t) {
    const std::size_t part = part_of(elements.hour[t]);
    const double volume = elements.volume[t];
    sectors[part].volume += volume;
    strain[part] += volume * strains.effective[t];
    compression[part] += volume * strains.least[t];
  }
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const std::size_t part = part_of(sample_hours[static_cast<Eigen::Index>(s)]);
    area[part] += samples[s].area;
    force[part] += samples[s].area * samples[s].pressure;
  }
  for (std::size_t s = 0; s < N; ++s) {
    if (sectors[s].volume > 0.0) {
      sectors[s].strain = strain[s] / sectors[s].volume;
      sectors[s].compression = compression[s] / sectors[s].volume;
    }
    if (area[s] > 0.0) sectors[s].mean_pressure = force[s] / area[s];
  }
}

/// Of friction on the socket about the joint centre, N·mm.
Vec3 friction_moment(const HipState& state, const HipSystem& system) {
  Vec3 moment = Vec3::Zero();
  if (!state.contact.friction()) return moment;
  VecX force = VecX::Zero(state.x.size());
  state.contact.friction()->add_force(state.x, VecX(), force);
  for (Index i = 0; i < system.n_acetabular(); ++i)
    moment += (state.x.segment<3>(3 * i) - system.centre()).cross(force.segment<3>(3 * i));
  return moment;
}

/// Looks for the element of a cartilage that has lost most of its volume.
void find_crushed(CrushFigures& crush, const TetMesh& mesh, const fem::ElasticForce& elasticity,
                  const VecX& x, const char* body) {
  VecX ratio(elasticity.n_elements());
  parallel_for(elasticity.n_elements(),
               [&](Index e) { ratio[e] = elasticity.deformation_gradient(x, e).determinant(); });
  Eigen::Index worst = 0;
  const double least = ratio.minCoeff(&worst);
  if (!(least < crush.least_volume_ratio)) return;
  const Points corners = mesh.points(mesh.tets.row(worst), Eigen::all);
  crush = {least, corners.colwise().mean().transpose(), body};
}

}  // namespace

SocketElements socket_elements(const JointModel& model) {
  const TetMesh& mesh = model.acetabular_cartilage;
  SocketElements elements{socket_clock(model), VecX(mesh.n_tets()),
                          tet_volumes(mesh.points, mesh.tets), VecX(mesh.n_vertices())};
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    const Points corners = mesh.points(mesh.tets.row(t), Eigen::all);
    elements.hour[t] = elements.clock.hour(corners.colwise().mean().transpose());
  }
  const TriangleTree bone(mesh.points, facets_with(mesh, FacetTag::bone_side));
  parallel_for(mesh.n_vertices(), [&](Index i) {
    elements.thickness[i] =
        std::sqrt(bone.nearest(mesh.points.row(i).transpose()).squared_distance);
  });
  return elements;
}

Reactions bone_reactions(const HipSystem& system, const VecX& force) {
  Reactions reactions;
  for (const Index i : system.socket_nodes()) reactions.socket += force.segment<3>(3 * i);
  for (const Index i : system.femur_nodes()) reactions.femur += force.segment<3>(3 * i);
  if (const auto& labrum = system.labrum()) {
    for (const Index i : labrum->held()) reactions.labrum += force.segment<3>(3 * i);
  }
  return reactions;
}

std::vector<collide::ContactSample> update_contact_figures(
    FrameResult& frame, const JointModel& model, const HipSystem& system, Equilibrium& equilibrium,
    const HipState& state, const ClockFace& clock) {
  const collide::SurfaceContact& cartilages = state.contact.cartilages();
  std::vector<collide::ContactSample> samples = cartilages.samples(state.x);
  fill_displacements(frame, model, system, state);
  fill_contact(frame, samples, samples_in_contact(system, state, samples), clock);
  fill_socket_nodes(frame, cartilages, samples, system.n_acetabular());
  add_bare_femur(frame, state.contact, state.x);
  fill_head_nodes(frame, model, system, state);

  BalanceFigures& balance = frame.balance;
  const Reactions reactions = bone_reactions(system, equilibrium.node_forces(state));
  balance.socket_reaction = reactions.socket;
  balance.femur_reaction = reactions.femur;
  balance.labrum_reaction = reactions.labrum;
  balance.elastic_energy = equilibrium.elastic_energy(state);
  balance.contact_force = state.contact.force(state.x);
  balance.friction_force = state.contact.friction_force(state.x);
  balance.friction_moment = friction_moment(state, system);
  balance.force_on_bone = state.contact.force_on_bone(state.x);
  balance.force_of_femur = state.contact.force_of_femur(state.x);
  balance.force_on_labrum = state.contact.force_on_labrum(state.x);
  if (system.ligaments()) {
    balance.ligament_force = system.ligaments()->pull(state.x);
    frame.ligament_tension = system.ligaments()->tensions(state.x);
  }
  frame.contact.penetration = state.contact.penetration(state.x);
  state.contact.for_each_constraint([&](const auto& contact, const auto& constraint) {
    const double gap = std::min(0.0, contact.gap(constraint, state.x));
    balance.contact_energy += 0.5 * contact.stiffness(constraint) * constraint.area * gap * gap;
  });
  if (const double size = balance.contact_force.norm(); size > 0.0) {
    const Vec3 left = reactions.socket + balance.force_on_bone + reactions.labrum +
                      reactions.femur - balance.force_of_femur;
    balance.reaction_error = left.norm() / size;
  }
  if (balance.applied_force.allFinite()) {
    const Vec3 left = balance.contact_force - balance.applied_force - balance.ligament_force;
    balance.force_error = left.norm() / balance.applied_force.norm();
  }
  if (system.labrum()) update_labrum_figures(frame, model, *system.labrum(), state);
  return samples;
}

void update_figures(FrameResult& frame, const JointModel& model, const HipSystem& system,
                    Equilibrium& equilibrium, const HipState& state,
                    const SocketElements& elements) {
  const std::vector<collide::ContactSample> samples =
      update_contact_figures(frame, model, system, equilibrium, state, elements.clock);
  frame.contact.peak_pressure_patch = patch_peak(samples, kPatchArea);
  frame.thin = thin_figures(samples_in_contact(system, state, samples), state.contact.cartilages(),
                            elements.thickness);
  find_crushed(frame.crush, model.acetabular_cartilage, system.socket_elasticity(), state.x,
               "acetabular cartilage");
  find_crushed(frame.crush, model.femoral_cartilage, system.femur_elasticity(), state.x,
               "femoral cartilage");
  if (const auto& labrum = system.labrum()) {
    find_crushed(frame.crush, model.labrum_body, labrum->elasticity().by_element(), state.x,
                 "labrum");
  }

  const ElementStrains strains = element_strains(system.socket_elasticity(), state.x);
  VecX hours(static_cast<Eigen::Index>(samples.size()));
  parallel_for(hours.size(), [&](Index s) {
    hours[s] = elements.clock.hour(samples[static_cast<std::size_t>(s)].point);
  });
  fill_sectors(frame.sectors, elements, strains, samples, hours, sector_of);
  fill_sectors(frame.regions, elements, strains, samples, hours, region_of);
}

}  // namespace coxa::joint
