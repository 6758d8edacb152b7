#pragma once

#include <coxa/collide/particle_surface.h>
#include <coxa/dynamics/particles.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/tri_mesh.h>

#include <optional>
#include <utility>
#include <vector>

namespace coxa::collide {

/// Direction along which a gap is measured.
enum class ContactNormal {
  nearest,  ///< towards the nearest point: the exact distance, direction jumps at edges
  smooth    ///< along interpolated vertex normals of the other surface: for near-conforming curved
            ///< surfaces
};

/// Where the slave surface is sampled.
enum class ContactQuadrature {
  vertices,      ///< once a vertex, a third of the area around it
  three_points,  ///< three points a triangle, exact for quadratics
  six_points     ///< six points a triangle, exact for quartics
};

struct ContactOptions {
  double stiffness = 100.0;      ///< MPa/mm, > 0: pressure for a millimetre of penetration
  double minimum_gap = 0.0;      ///< mm: the surfaces are pushed apart below this distance
  double search_distance = 3.0;  ///< mm, > 0: samples farther from the other surface are not paired
  double facing = -1.0;          ///< in [-1, 1): least -n_slave·n_other of a pair; -1 accepts all
  ContactNormal normal = ContactNormal::nearest;
  ContactQuadrature quadrature = ContactQuadrature::three_points;
};

/// A slave sample and what it faces, frozen between two calls of update_pairs:
/// gap = normal · sum of weight x[particle] over stencil [first, last) - offset.
struct ContactPair {
  Index sample = 0;            ///< number in [0, n_samples)
  Index other_triangle = 0;    ///< of the other surface
  Vec3 normal = Vec3::Zero();  ///< unit, from the other surface towards the slave
  double offset = 0.0;         ///< mm
  double area = 0.0;           ///< mm²
  Index first = 0, last = 0;   ///< range in the stencil
};

/// State of one slave sample.
struct ContactSample {
  Index triangle = 0;  ///< of the slave surface
  Vec3 barycentric = Vec3::Zero();
  Vec3 point = Vec3::Zero();   ///< mm
  Vec3 normal = Vec3::Zero();  ///< of the pair; zero where there is none
  double area = 0.0;           ///< mm²
  double gap = kNaN;           ///< mm, beyond minimum_gap; NaN where there is no pair
  double pressure = 0.0;       ///< MPa, >= 0
};

/// Frictionless contact between a slave surface and another surface, by penalty and optional
/// multipliers.
///
/// Every slave sample of area a meets the pressure p = max(0, multiplier - stiffness · gap) of the
/// other surface and returns it there barycentrically. Force, Jacobian and energy belong to the
/// pairs of the last update_pairs and are exactly consistent with each other.
/// @note the pattern changes with update_pairs; with a rigid obstacle it never does. Bit-identical
/// for any
///       number of threads.
/// Source: Hirota et al. 2001 (penalty with surface quadrature); augmented Lagrangian as in
/// docs/collide.md.
class SurfaceContact : public dynamics::Force {
 public:
  /// Two surfaces of particles.
  SurfaceContact(ParticleSurface slave, ParticleSurface other, const ContactOptions& options = {});
  /// A surface of particles kept outside a rigid obstacle.
  SurfaceContact(ParticleSurface slave, TriMesh obstacle, const ContactOptions& options = {});

  /// Searches the pairs anew at particle positions x (3n values).
  void update_pairs(const VecX& x);
  /// Moves the obstacle's vertices; takes effect at the next update_pairs.
  void update_obstacle(const Points& points);
  /// Sets every multiplier to the pressure at x, and returns the largest penetration, mm.
  double update_multipliers(const VecX& x);
  void clear_multipliers();
  void update_stiffness(double stiffness);

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX& x) const override;

  double gap(const ContactPair& pair, const VecX& x) const;       ///< mm, beyond minimum_gap
  double pressure(const ContactPair& pair, const VecX& x) const;  ///< MPa
  double stiffness() const { return options_.stiffness; }
  const std::vector<ContactPair>& pairs() const { return pairs_; }
  const std::vector<Index>& stencil_particles() const { return stencil_particles_; }
  const std::vector<double>& stencil_weights() const { return stencil_weights_; }
  Index n_samples() const { return static_cast<Index>(samples_.size()); }
  /// All samples at x, paired or not.
  std::vector<ContactSample> samples(const VecX& x) const;
  const ParticleSurface& slave() const { return slave_; }

 private:
  struct Candidate;
  void make_samples();
  void update_areas(const VecX& areas);
  void prepare_other(const VecX& x);
  void append_pair(Index sample, const Candidate& candidate, double area);

  ContactOptions options_;
  ParticleSurface slave_;
  std::optional<ParticleSurface> other_;  ///< nullopt: rigid obstacle
  TriMesh other_mesh_;                    ///< current positions of the other surface
  std::vector<ContactSample> samples_;    ///< triangle and barycentric; areas as of the last update
  std::vector<double> multiplier_;        ///< per sample, MPa
  std::optional<TriangleTree> tree_;
  Eigen::Matrix<bool, Eigen::Dynamic, 3, Eigen::RowMajor> boundary_edge_;
  std::vector<bool> boundary_vertex_;
  std::vector<ContactPair> pairs_;
  std::vector<Index> stencil_particles_;
  std::vector<double> stencil_weights_;
};

}  // namespace coxa::collide
