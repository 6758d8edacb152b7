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
  six_points,    ///< six points a triangle, exact for quartics
  cut  ///< three points in each piece of a triangle, cut along the other surface's edges: passes
       ///< the contact patch test; needs the nodal rule, and costs several times as many samples
};

/// What is kept from overlapping.
enum class ContactRule {
  pointwise,  ///< every sample by itself
  nodal  ///< every slave vertex, by the mean of the gaps around it weighted with its shape function
         ///< (mortar)
};

struct ContactOptions {
  double stiffness = 100.0;      ///< MPa/mm, > 0: pressure for a millimetre of penetration
  double minimum_gap = 0.0;      ///< mm: the surfaces are pushed apart below this distance
  double search_distance = 3.0;  ///< mm, > 0: samples farther from the other surface are not paired
  double facing = -1.0;          ///< in [-1, 1): least -n_slave·n_other of a pair; -1 accepts all
  /// In [facing, 1): pairs that face each other less than this count for a part of their area, down
  /// to none at `facing`, so that a surface that turns away leaves contact little by little; below
  /// `facing` there is no such range.
  double facing_fully = -1.0;
  ContactNormal normal = ContactNormal::nearest;
  ContactQuadrature quadrature = ContactQuadrature::three_points;
  ContactRule rule = ContactRule::pointwise;
};

enum class SearchHint;  // pair_search.h

/// A slave sample and the point of the other surface that it faces.
struct ContactPair {
  Index sample = 0;
  Index other_triangle = 0;
  Vec3 other_barycentric = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< unit, from the other surface towards the slave
  double offset = 0.0;         ///< mm: gap = normal · (sample - point) - offset
  double share = 1.0;  ///< in (0, 1], of the sample's area, by how well they face each other
};

/// One thing kept from overlapping, frozen between two calls of update_pairs:
/// gap = sum of stencil_vectors[k] · x[stencil_particles[k]] over [first, last) - offset.
struct ContactConstraint {
  Index owner = 0;  ///< the sample, or the slave surface's vertex with the nodal rule
  Vec3 normal =
      Vec3::Zero();     ///< from the other surface towards the slave; a mean with the nodal rule
  double offset = 0.0;  ///< mm
  double area = 0.0;    ///< mm²
  Index first = 0, last = 0;  ///< range in the stencil
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
  ///
  /// With a finite `reach` (mm; nodal rule) vertices that are farther than that from the other
  /// surface have no constraint, and those that cannot have come so near since they were last
  /// searched for cost nothing. What presses is the same either way.
  ///
  /// With `slide` in (0, 1) the way of two paired surfaces across their normal counts for so much
  /// only: their gap is taken not to change faster than that along them. Fewer are searched, and
  /// what a steeper place brings near is found a step late. Those are looked for from the triangle
  /// that was nearest before, across its edges: the nearest place thereabouts, not of all.
  void update_pairs(const VecX& x, double reach = kInfinity, double slide = 1.0);
  /// Makes the next search look at every sample, whatever was known of its clearance.
  void forget_clearances();
  /// Moves the obstacle's vertices; takes effect at the next update_pairs.
  void update_obstacle(const Points& points);
  /// Takes the surfaces as smooth with the curvature they have at x: from now on samples and the
  /// points they face lie on quadratic patches through the vertices instead of on flat triangles.
  void update_curvature(const VecX& x);
  /// Sets every multiplier to the pressure at x, and returns the largest penetration, mm. Where a
  /// penetration above `tolerance` (mm) has not halved since the last call, the constraint becomes
  /// four times as stiff (Bertsekas 1982), up to 1024 times: multipliers alone converge slowly
  /// where the bodies are stiffer than the penalty.
  double update_multipliers(const VecX& x, double tolerance = kInfinity);
  /// Gives every constraint the common stiffness again; multipliers stay.
  void clear_stiffening();
  /// Forgets multipliers and stiffening.
  void clear_multipliers();
  void update_stiffness(double stiffness);

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX& x) const override;

  double gap(const ContactConstraint& constraint, const VecX& x) const;  ///< mm, beyond minimum_gap
  double pressure(const ContactConstraint& constraint, const VecX& x) const;  ///< MPa
  double stiffness() const { return options_.stiffness; }
  /// Of one constraint, MPa/mm: its stiffening included.
  double stiffness(const ContactConstraint& constraint) const {
    return options_.stiffness * stiffening_[static_cast<std::size_t>(constraint.owner)];
  }
  const std::vector<ContactConstraint>& constraints() const { return constraints_; }
  const std::vector<Index>& stencil_particles() const { return stencil_particles_; }
  const std::vector<Vec3>& stencil_vectors() const { return stencil_vectors_; }
  Index n_samples() const { return static_cast<Index>(samples_.size()); }
  /// All samples at x, paired or not.
  std::vector<ContactSample> samples(const VecX& x) const;
  const ParticleSurface& slave() const { return slave_; }

 private:
  using Entries = std::vector<std::pair<Index, Vec3>>;  // particle, d gap / d x
  void make_samples();
  void update_areas(const VecX& areas);
  void prepare_other(const VecX& x);
  void update_clearances(const Points& slave, double slide);
  std::vector<char> owners_within(double reach) const;
  std::vector<Index> samples_of(const std::vector<char>& wanted) const;
  void note_unpaired(std::size_t sample, const Vec3& point,
                     const std::optional<NearestPoint>& nearest, bool outside);
  std::optional<ContactPair> find_pair(Index sample, const Vec3& point, const Vec3& normal,
                                       SearchHint hint);
  double clearance(const ContactPair& pair, const Vec3& point, double distance) const;
  void append_entries(const ContactPair& pair, double share, Entries& entries) const;
  void append_constraint(ContactConstraint constraint, Entries& entries);
  void forget(std::size_t owner);
  void make_pointwise_constraints();
  void make_nodal_constraints(const std::vector<char>& wanted);
  std::vector<std::vector<Index>> slave_groups() const;
  double obstacle_height(const ContactPair& pair) const;
  Vec3 other_point(const ContactPair& pair, const Points& points) const;

  ContactOptions options_;
  ParticleSurface slave_;
  std::optional<ParticleSurface> other_;    ///< nullopt: rigid obstacle
  TriMesh other_mesh_;                      ///< current positions of the other surface
  Points other_normals_;                    ///< at its vertices, for these positions
  std::vector<ContactSample> samples_;      ///< as of the last update of pairs
  Points slave_bulge_, other_bulge_;        ///< per triangle and edge, mm; empty: flat facets
  std::vector<double> clearance_;           ///< per sample: no gap is smaller than this, mm
  Points searched_slave_, searched_other_;  ///< the surfaces at the last search
  std::vector<Index> nearest_;         ///< per sample: nearest triangle of its last search, or -1
  std::vector<Vec3> searched_normal_;  ///< per sample: of its last pair, or from the nearest point
  std::vector<double> multiplier_;     ///< per owner, MPa
  std::vector<double> stiffening_;     ///< per owner, >= 1
  std::vector<double> overlap_;        ///< per owner, mm, at the last update of multipliers
  std::optional<TriangleTree> tree_;
  Triangles other_neighbours_;  ///< across the edges of the other surface, -1: border
  std::vector<bool> boundary_vertex_;
  std::vector<ContactPair> pairs_;  ///< ascending sample
  std::vector<ContactConstraint> constraints_;
  std::vector<Index> stencil_particles_;
  std::vector<Vec3> stencil_vectors_;
};

}  // namespace coxa::collide
