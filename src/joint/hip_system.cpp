#include "hip_system.h"

#include <coxa/dynamics/system.h>
#include <coxa/geom/fits.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/tet_quality.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace coxa::joint {
namespace {

// articular surfaces look for each other this far, mm; deeper overlaps and wider gaps are not
// paired
constexpr double kSearchDistance = 4.0;
// bare bone is rarely reached and never deep: most of the femoral cartilage has none so near, mm
constexpr double kBoneSearch = 1.5;
// bare femur farther out than the socket's cartilage by more than this is never reached, mm
constexpr double kFemurReach = 10.0;
// a labrum made apart from the head may overlap it by so much at first, mm
constexpr double kLabrumSearch = 3.0;
// all only where they face each other: not at all beyond about 80 degrees, fully within 60
constexpr double kFacing = 0.2, kFacingFully = 0.5;

collide::ContactOptions contact_options(
    double stiffness, double search_distance,
    collide::ContactQuadrature quadrature = collide::ContactQuadrature::three_points) {
  return {.stiffness = stiffness,
          .search_distance = search_distance,
          .facing = kFacing,
          .facing_fully = kFacingFully,
          .normal = collide::ContactNormal::smooth,
          .quadrature = quadrature,
          .rule = collide::ContactRule::nodal};
}

std::vector<Index> nodes_of(const Triangles& facets, Index first) {
  std::vector<Index> nodes(facets.data(), facets.data() + facets.size());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  for (Index& node : nodes) node += first;
  return nodes;
}

/// Volume over articular area, mm.
double mean_thickness(const TetMesh& mesh) {
  return tet_volumes(mesh.points, mesh.tets).sum() /
         area({mesh.points, facets_with(mesh, FacetTag::articular_side)});
}

/// Largest distance of a node of the facets from a point, mm.
double radius_about(const Vec3& centre, const TetMesh& mesh, const Triangles& facets) {
  double radius = 0.0;
  for (const Index node : nodes_of(facets, 0)) {
    radius = std::max(radius, (mesh.points.row(node).transpose() - centre).norm());
  }
  return radius;
}

/// A surface of the femur as particles: every vertex also follows the translation.
collide::ParticleSurface carried(const Triangles& femoral, Index first, Index translation) {
  const auto head = collide::make_particle_surface((femoral.array() + first).matrix());
  collide::ParticleSurface surface;
  surface.triangles = head.triangles;
  surface.row_start = {0};
  for (const Index particle : head.particle) {
    surface.particle.insert(surface.particle.end(), {particle, translation});
    surface.weight.insert(surface.weight.end(), {1.0, 1.0});
    surface.row_start.push_back(static_cast<Index>(surface.particle.size()));
  }
  return surface;
}

/// The triangles with a corner in a ball.
TriMesh part_within(const TriMesh& mesh, const Vec3& centre, double radius) {
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const auto near = [&](Index v) {
      return (mesh.points.row(v).transpose() - centre).norm() <= radius;
    };
    const auto corners = mesh.triangles.row(t);
    if (std::any_of(corners.begin(), corners.end(), near)) kept.push_back(t);
  }
  return {mesh.points, mesh.triangles(kept, Eigen::all)};
}

}  // namespace

BonePose between(const BonePose& a, const BonePose& b, double s) {
  const Vec3 turn = rotation_vector(b.R * a.R.transpose());
  return {rotation_from_vector(s * turn) * a.R, (1.0 - s) * a.shift + s * b.shift};
}

HipSystem::HipSystem(const JointModel& model)
    : model_(model),
      n_acetabular_(model.acetabular_cartilage.n_vertices()),
      n_femoral_(model.femoral_cartilage.n_vertices()),
      centre_(model.X_IF.p),
      socket_nodes_(nodes_of(facets_with(model.acetabular_cartilage, FacetTag::bone_side), 0)),
      femur_nodes_(
          nodes_of(facets_with(model.femoral_cartilage, FacetTag::bone_side), n_acetabular_)),
      socket_elasticity_(model.acetabular_cartilage, 0, model.material),
      femur_elasticity_(model.femoral_cartilage, n_acetabular_, model.material) {
  const double E = model.material.youngs_modulus, nu = model.material.poissons_ratio;
  const double confined_modulus = E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
  foundation_stiffness_ = confined_modulus / (mean_thickness(model.acetabular_cartilage) +
                                              mean_thickness(model.femoral_cartilage));
  const bool has_labrum = model.labrum_body.n_tets() > 0;
  if (model.bare_bone == BareBone::both || (has_labrum && !model.femur.empty())) add_bare_femur();
  if (!model.ligaments.empty()) add_ligaments();
  if (has_labrum) labrum_.emplace(model, first_labrum_node());
}

void HipSystem::add_bare_femur() {
  const Triangles socket = facets_with(model_.acetabular_cartilage, FacetTag::articular_side);
  const double radius = radius_about(centre_, model_.acetabular_cartilage, socket);
  const TriMesh near = part_within(model_.femur, centre_, radius + kFemurReach);
  const std::vector<Index> kept = nodes_of(near.triangles, 0);
  femur_points_ = near.points(kept, Eigen::all);
  bare_femur_ = near.triangles;
  for (Index& vertex : bare_femur_.reshaped()) {
    vertex = static_cast<Index>(std::lower_bound(kept.begin(), kept.end(), vertex) - kept.begin());
  }
}

void HipSystem::add_ligaments() {
  const auto first = femur_points_.rows();
  const auto n = static_cast<Eigen::Index>(model_.ligaments.size());
  femur_points_.conservativeResize(first + n + 1, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    femur_points_.row(first + k) =
        model_.ligaments[static_cast<std::size_t>(k)].insertion.transpose();
  }
  femur_points_.row(first + n) = centre_.transpose();
  const Index insertions = first_femur_point() + static_cast<Index>(first);
  ligaments_.emplace(model_.ligaments, insertions, insertions + static_cast<Index>(n),
                     translation());
}

VecX HipSystem::reference() const {
  VecX x = VecX::Zero(3 * n_particles());
  for (Index i = 0; i < n_acetabular_; ++i) {
    x.segment<3>(3 * i) = model_.acetabular_cartilage.points.row(i).transpose();
  }
  for (Index i = 0; i < n_femoral_; ++i) {
    x.segment<3>(3 * (n_acetabular_ + i)) = model_.femoral_cartilage.points.row(i).transpose();
  }
  for (Index i = 0; i < static_cast<Index>(femur_points_.rows()); ++i) {
    x.segment<3>(3 * (first_femur_point() + i)) = femur_points_.row(i).transpose();
  }
  for (Index i = 0; labrum_ && i < labrum_->n_nodes(); ++i) {
    x.segment<3>(3 * (labrum_->first() + i)) = model_.labrum_body.points.row(i).transpose();
  }
  return x;
}

void HipSystem::update_pose(VecX& x, const BonePose& from, const BonePose& to) const {
  const Mat3 turn = to.R * from.R.transpose();
  for (Index i = n_acetabular_; i < translation(); ++i) {
    const Vec3 arm = x.segment<3>(3 * i) - centre_ - from.shift;
    x.segment<3>(3 * i) = centre_ + to.shift + turn * arm;
  }
  // held nodes exactly, so that rounding does not add up over many sub-steps
  for (const Index i : femur_nodes_) {
    const Vec3 X = model_.femoral_cartilage.points.row(i - n_acetabular_);
    x.segment<3>(3 * i) = centre_ + to.shift + to.R * (X - centre_);
  }
  for (Index i = 0; i < static_cast<Index>(femur_points_.rows()); ++i) {
    const Vec3 X = femur_points_.row(i);
    x.segment<3>(3 * (first_femur_point() + i)) = centre_ + to.shift + to.R * (X - centre_);
  }
}

HipContact HipSystem::make_contact(double stiffness, double reach) const {
  return {make_cartilage_contact(stiffness), make_bone_contact(stiffness, reach),
          make_femur_contact(stiffness), make_labrum_contacts(stiffness), make_friction(stiffness)};
}

collide::SurfaceContact HipSystem::make_cartilage_contact(double stiffness) const {
  const Triangles socket = facets_with(model_.acetabular_cartilage, FacetTag::articular_side);
  const Triangles femoral = facets_with(model_.femoral_cartilage, FacetTag::articular_side);
  // sample the socket more densely where its facets are the larger ones
  const double socket_edge = mean_edge_length({model_.acetabular_cartilage.points, socket});
  const double head_edge = mean_edge_length({model_.femoral_cartilage.points, femoral});
  const auto quadrature = socket_edge > head_edge ? collide::ContactQuadrature::six_points
                                                  : collide::ContactQuadrature::three_points;
  collide::SurfaceContact contact(collide::make_particle_surface(socket),
                                  carried(femoral, n_acetabular_, translation()),
                                  contact_options(stiffness, kSearchDistance, quadrature));
  contact.update_curvature(reference());
  return contact;
}

std::optional<collide::SurfaceContact> HipSystem::make_bone_contact(double stiffness,
                                                                    double reach) const {
  const Triangles femoral = facets_with(model_.femoral_cartilage, FacetTag::articular_side);
  const double radius = radius_about(centre_, model_.femoral_cartilage, femoral);
  TriMesh bone = part_within(model_.hip_bone, centre_, radius + kBoneSearch + reach);
  if (bone.empty()) return std::nullopt;
  return collide::SurfaceContact(carried(femoral, n_acetabular_, translation()), std::move(bone),
                                 contact_options(stiffness, kBoneSearch));
}

std::optional<collide::SurfaceContact> HipSystem::make_femur_contact(double stiffness) const {
  if (model_.bare_bone != BareBone::both || bare_femur_.rows() == 0) return std::nullopt;
  const Triangles socket = facets_with(model_.acetabular_cartilage, FacetTag::articular_side);
  collide::SurfaceContact contact(collide::make_particle_surface(socket),
                                  carried(bare_femur_, first_femur_point(), translation()),
                                  contact_options(stiffness, kBoneSearch));
  contact.update_curvature(reference());
  return contact;
}

/// As stiff against slip as contact against overlap.
std::optional<collide::ContactFriction> HipSystem::make_friction(double stiffness) const {
  if (model_.friction == 0.0) return std::nullopt;
  return collide::ContactFriction(model_.friction, stiffness);
}

std::vector<collide::SurfaceContact> HipSystem::make_labrum_contacts(double stiffness) const {
  std::vector<collide::SurfaceContact> contacts;
  if (!labrum_) return contacts;
  const auto add = [&](collide::ParticleSurface other) {
    contacts.emplace_back(collide::make_particle_surface(labrum_->surface()), std::move(other),
                          contact_options(stiffness, kLabrumSearch));
  };
  const Triangles femoral = facets_with(model_.femoral_cartilage, FacetTag::articular_side);
  add(carried(femoral, n_acetabular_, translation()));
  if (bare_femur_.rows() > 0) add(carried(bare_femur_, first_femur_point(), translation()));
  return contacts;
}

std::vector<const CartilageElasticity*> HipSystem::bodies() const {
  std::vector<const CartilageElasticity*> bodies{&socket_elasticity_, &femur_elasticity_};
  if (labrum_) bodies.push_back(&labrum_->elasticity());
  return bodies;
}

std::vector<std::pair<Index, Index>> HipSystem::elastic_pattern() const {
  std::vector<const dynamics::Force*> forces;
  for (const CartilageElasticity* body : bodies()) forces.push_back(&body->by_element());
  if (ligaments_) forces.push_back(&*ligaments_);
  return dynamics::total_pattern(forces);
}

void HipSystem::add_elastic_jacobian(const VecX& x, solve::BlockMatrix& A) const {
  for (const CartilageElasticity* body : bodies()) body->add_element_jacobian(x, A);
  if (ligaments_) ligaments_->add_jacobian(x, VecX(), 1.0, 0.0, A);
}

std::vector<const fem::MeanDilatation*> HipSystem::patches() const {
  std::vector<const fem::MeanDilatation*> patches;
  for (const CartilageElasticity* body : bodies())
    if (body->by_patch() != nullptr) patches.push_back(body->by_patch());
  return patches;
}

VecX HipSystem::elastic_force(const VecX& x, double& energy) const {
  VecX force = VecX::Zero(x.size());
  energy = 0.0;
  for (const CartilageElasticity* body : bodies()) energy += body->add_force_with_energy(x, force);
  if (ligaments_) {
    ligaments_->add_force(x, VecX(), force);
    energy += ligaments_->energy(x);
  }
  return force;
}

std::vector<bool> HipSystem::free_particles(LoadMode mode) const {
  std::vector<bool> free(static_cast<std::size_t>(n_particles()), true);
  for (const Index i : socket_nodes_) free[static_cast<std::size_t>(i)] = false;
  for (const Index i : femur_nodes_) free[static_cast<std::size_t>(i)] = false;
  std::fill(free.begin() + first_femur_point(), free.begin() + first_labrum_node(), false);
  if (labrum_) {
    for (const Index i : labrum_->held()) free[static_cast<std::size_t>(i)] = false;
  }
  if (mode == LoadMode::prescribed_pose) free[static_cast<std::size_t>(translation())] = false;
  return free;
}

}  // namespace coxa::joint
