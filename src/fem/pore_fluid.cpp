#include <coxa/fem/pore_fluid.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/cross_matrix.h>

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

#include "cofactor.h"
#include "element_shape.h"
#include "scatter.h"

namespace coxa::fem {
namespace {

using Size = std::size_t;

void check(const Permeability& k, const PoreFluidOptions& options, int n_nodes) {
  require(k.reference > 0.0, "the permeability must be positive, got ", k.reference, " mm4/(N s)");
  require(0.0 <= k.solid_share && k.solid_share < 1.0, "the solid's share must be in [0, 1), got ",
          k.solid_share);
  require(k.exponent >= 0.0 && k.stiffening >= 0.0,
          "exponent and stiffening of the permeability must not be negative, got ", k.exponent,
          " and ", k.stiffening);
  require(options.pressure_unit > 0.0, "the pressure unit must be positive, got ",
          options.pressure_unit, " MPa/mm");
  require(options.stabilisation >= 0.0, "the stabilisation must not be negative, got ",
          options.stabilisation, " 1/MPa");
  require(n_nodes == 10 || options.stabilisation > 0.0,
          "four-node elements need a positive stabilisation, about 1 / (2 shear modulus): ",
          "otherwise their pressures oscillate");
}

}  // namespace

double Permeability::at(double J) const {
  const double room = std::max(0.0, J - solid_share) / (1.0 - solid_share);
  return reference * std::pow(room, exponent) * std::exp(0.5 * stiffening * (J * J - 1.0));
}

struct PoreFluid::Impl {
  /// An integration point: what of it does not change, and what the step starts with.
  struct Point {
    double weight;                         // mm³
    Eigen::Vector4d barycentric;           // values of the pressures' functions
    std::array<Vec3, 4> slope;             // their slopes, 1/mm
    double J = 1.0;                        // at the step's start
    Mat3 conductivity = Mat3::Zero();      // k J C^-1 there, mm⁴/(N s)
    Mat3 spatial_mobility = Mat3::Zero();  // k F^-T there
  };

  Impl(const TetMesh& mesh, const Permeability& permeability_, const PoreFluidOptions& options_)
      : permeability(permeability_),
        options(options_),
        n_nodes(nodes_per_element(mesh)),
        rest(mesh.points),
        mid_ends(mesh.n_vertices(), {-1, -1}),
        pressure_of(static_cast<Size>(mesh.n_vertices()), -1) {
    check(permeability, options, n_nodes);
    check_connectivity(mesh);
    number_pressures(mesh);
    std::vector<std::int64_t> start{0};
    std::vector<Index> particle;
    for (Index e = 0; e < mesh.n_tets(); ++e) {
      add_points(element_shape(mesh, e));
      for (int a = 0; a < n_nodes; ++a) particle.push_back(element_node(mesh, e, a));
      for (int a = 0; a < 4; ++a)
        particle.push_back(pressure_of[static_cast<Size>(mesh.tets(e, a))]);
      start.push_back(static_cast<std::int64_t>(particle.size()));
    }
    scatter = Scatter(std::move(start), std::move(particle));
    pressure_at_start = VecX::Zero(n_particles);
  }

  void number_pressures(const TetMesh& mesh) {
    for (const Index node : mesh.tets.reshaped()) pressure_of[static_cast<Size>(node)] = 0;
    n_particles = mesh.n_vertices();
    for (Index& particle : pressure_of)
      if (particle == 0) particle = n_particles++;
    for (Index e = 0; n_nodes == 10 && e < mesh.n_tets(); ++e)
      for (int k = 0; k < 6; ++k) {
        const auto [a, b] = kEdgeCorners[static_cast<Size>(k)];
        mid_ends[static_cast<Size>(mesh.mid_nodes(e, k))] = {mesh.tets(e, a), mesh.tets(e, b)};
      }
  }

  void add_points(const ElementShape& shape) {
    n_points = static_cast<int>(shape.weight.size());
    for (Size q = 0; q < shape.weight.size(); ++q) {
      Point point{shape.weight[q], shape.barycentric[q], {}};
      for (Size a = 0; a < 4; ++a) point.slope[a] = shape.corner_gradient[4 * q + a];
      points.push_back(point);
    }
    gradient.insert(gradient.end(), shape.gradient.begin(), shape.gradient.end());
  }

  Index n_elements() const { return scatter.n_groups(); }
  Size point_number(Index e, int q) const {
    return static_cast<Size>(e) * static_cast<Size>(n_points) + static_cast<Size>(q);
  }
  const Vec3& shape_gradient(Index e, int q, int a) const {
    return gradient[point_number(e, q) * static_cast<Size>(n_nodes) + static_cast<Size>(a)];
  }
  Mat3 gradient_of(const VecX& x, Index e, int q) const {
    Mat3 F = Mat3::Zero();
    for (int a = 0; a < n_nodes; ++a) {
      const Index particle = scatter.particle(scatter.slot(e) + static_cast<Size>(a));
      F += x.segment<3>(3 * Eigen::Index{particle}) * shape_gradient(e, q, a).transpose();
    }
    return F;
  }
  Index corner_particle(Index e, int a) const {
    return scatter.particle(scatter.slot(e) + static_cast<Size>(n_nodes + a));
  }
  /// Pressures at the corners, MPa.
  Eigen::Vector4d corner_pressures(const VecX& x, Index e) const {
    Eigen::Vector4d p;
    for (int a = 0; a < 4; ++a)
      p[a] = options.pressure_unit * x[3 * Eigen::Index{corner_particle(e, a)}];
    return p;
  }
  Eigen::Vector4d corner_pressures_at_start(Index e) const {
    Eigen::Vector4d p;
    for (int a = 0; a < 4; ++a) p[a] = pressure_at_start[corner_particle(e, a)];
    return p;
  }
  double element_volume(Index e) const {
    double volume = 0.0;
    for (int q = 0; q < n_points; ++q) volume += points[point_number(e, q)].weight;
    return volume;
  }
  /// Slope of the pressure in the reference shape, MPa/mm.
  static Vec3 pressure_slope(const Point& point, const Eigen::Vector4d& p) {
    Vec3 slope = Vec3::Zero();
    for (Size a = 0; a < 4; ++a) slope += p[static_cast<Eigen::Index>(a)] * point.slope[a];
    return slope;
  }

  void element_force(const VecX& x, Index e, Vec3* part) const;
  void element_blocks(const VecX& x, Index e, double factor, Mat3* blocks) const;
  /// Of the energy that punishes a change's deviation from its mean over the element, mm³/MPa.
  double calming(Index e, int a, int b) const {
    return options.stabilisation * element_volume(e) * ((a == b ? 0.1 : 0.05) - 1.0 / 16.0);
  }

  Permeability permeability;
  PoreFluidOptions options;
  int n_nodes = 4, n_points = 1;
  Points rest;
  std::vector<std::array<Index, 2>> mid_ends;  // of nodes in the middle of edges
  std::vector<Index> pressure_of;              // particle of each node's pressure, -1: no corner
  Index n_particles = 0;
  std::vector<Point> points;   // M × n_points
  std::vector<Vec3> gradient;  // M × n_points × n_nodes, 1/mm
  Scatter scatter;             // elements to particles: nodes, then pressures
  VecX pressure_at_start;      // by particle, MPa
  double time_step = 0.0;      // s; 0: no step has begun
};

void PoreFluid::Impl::element_force(const VecX& x, Index e, Vec3* part) const {
  std::fill_n(part, n_nodes + 4, Vec3::Zero());
  const Eigen::Vector4d p = corner_pressures(x, e), change = p - corner_pressures_at_start(e);
  const double unit = options.pressure_unit;
  for (int q = 0; q < n_points; ++q) {
    const Point& point = points[point_number(e, q)];
    const Mat3 F = gradient_of(x, e, q);
    const Mat3 push = point.weight * point.barycentric.dot(p) * cofactor(F);
    for (int a = 0; a < n_nodes; ++a) part[a] += push * shape_gradient(e, q, a);
    const double swelling = F.determinant() - point.J;
    const Vec3 flow = time_step * point.conductivity * pressure_slope(point, p);
    for (int a = 0; a < 4; ++a)
      part[n_nodes + a][0] +=
          unit * point.weight *
          (point.barycentric[a] * swelling + point.slope[static_cast<Size>(a)].dot(flow));
  }
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) part[n_nodes + a][0] += unit * calming(e, a, b) * change[b];
}

void PoreFluid::Impl::element_blocks(const VecX& x, Index e, double factor, Mat3* blocks) const {
  const int n = n_nodes + 4;
  std::fill_n(blocks, n * (n + 1) / 2, Mat3::Zero());
  const auto block = [&](int a, int b) -> Mat3& { return blocks[Scatter::block_number(n, a, b)]; };
  const Eigen::Vector4d p = corner_pressures(x, e);
  const double unit = options.pressure_unit;
  for (int q = 0; q < n_points; ++q) {
    const Point& point = points[point_number(e, q)];
    const double weight = factor * point.weight;
    const Mat3 F = gradient_of(x, e, q), C = cofactor(F);
    const Mat3 squeezed = weight * point.barycentric.dot(p) * F;
    for (int a = 0; a < n_nodes; ++a) {
      const Vec3& r = shape_gradient(e, q, a);
      // d2J / dx_a dx_b = -[F (r_a x r_b)]x
      for (int b = a; b < n_nodes; ++b)
        block(a, b) += cross_matrix(squeezed * r.cross(shape_gradient(e, q, b)));
      const Vec3 coupling = weight * unit * (C * r);
      for (int b = 0; b < 4; ++b) block(a, n_nodes + b).col(0) -= point.barycentric[b] * coupling;
    }
    for (int a = 0; a < 4; ++a) {
      const Vec3 flow =
          time_step * weight * unit * unit * point.conductivity * point.slope[static_cast<Size>(a)];
      for (int b = a; b < 4; ++b)
        block(n_nodes + a, n_nodes + b)(0, 0) -= flow.dot(point.slope[static_cast<Size>(b)]);
    }
  }
  for (int a = 0; a < 4; ++a)
    for (int b = a; b < 4; ++b)
      block(n_nodes + a, n_nodes + b)(0, 0) -= factor * unit * unit * calming(e, a, b);
}

PoreFluid::PoreFluid(const TetMesh& mesh, const Permeability& permeability,
                     const PoreFluidOptions& options)
    : impl_(std::make_unique<Impl>(mesh, permeability, options)) {}

PoreFluid::~PoreFluid() = default;

Index PoreFluid::n_particles() const { return impl_->n_particles; }

Index PoreFluid::pressure_particle(Index node) const {
  require(node >= 0 && node < static_cast<Index>(impl_->pressure_of.size()) &&
              impl_->pressure_of[static_cast<Size>(node)] >= 0,
          "node ", node, " is no corner of an element and carries no pressure");
  return impl_->pressure_of[static_cast<Size>(node)];
}

VecX PoreFluid::reference() const {
  VecX x = VecX::Zero(3 * Eigen::Index{n_particles()});
  for (Eigen::Index i = 0; i < impl_->rest.rows(); ++i)
    x.segment<3>(3 * i) = impl_->rest.row(i).transpose();
  return x;
}

void PoreFluid::add_unused(dynamics::Constraints& constraints) const {
  for (Index i = static_cast<Index>(impl_->rest.rows()); i < n_particles(); ++i)
    constraints.add(i, Vec3(1, 0, 0).asDiagonal(), Vec3::Zero());
}

void PoreFluid::add_drained(const std::vector<Index>& nodes,
                            dynamics::Constraints& constraints) const {
  for (const Index node : nodes) {
    require(node >= 0 && node < static_cast<Index>(impl_->pressure_of.size()), "there is no node ",
            node);
    const Index particle = impl_->pressure_of[static_cast<Size>(node)];
    if (particle >= 0) constraints.hold(particle);
  }
}

void PoreFluid::begin_step(const VecX& x, double time_step) {
  require(time_step > 0.0, "the time step must be positive, got ", time_step, " s");
  impl_->time_step = time_step;
  for (const Index particle : impl_->pressure_of)
    if (particle >= 0)
      impl_->pressure_at_start[particle] =
          impl_->options.pressure_unit * x[3 * Eigen::Index{particle}];
  parallel_for(impl_->n_elements(), [&](Index e) {
    for (int q = 0; q < impl_->n_points; ++q) {
      Impl::Point& point = impl_->points[impl_->point_number(e, q)];
      const Mat3 F = impl_->gradient_of(x, e, q);
      point.J = F.determinant();
      const Mat3 inverse = F.inverse();
      point.spatial_mobility = impl_->permeability.at(point.J) * inverse.transpose();
      point.conductivity = point.J * inverse * point.spatial_mobility;
    }
  });
}

std::vector<std::pair<Index, Index>> PoreFluid::pattern() const { return impl_->scatter.pattern(); }

void PoreFluid::add_force(const VecX& x, const VecX&, VecX& force) const {
  COXA_ASSERT(impl_->time_step > 0.0);
  const auto part = std::make_unique_for_overwrite<Vec3[]>(impl_->scatter.n_slots());
  parallel_for(impl_->n_elements(),
               [&](Index e) { impl_->element_force(x, e, &part[impl_->scatter.slot(e)]); });
  impl_->scatter.gather_force(part.get(), force);
}

void PoreFluid::add_jacobian(const VecX& x, const VecX&, double stiffness_factor, double,
                             solve::BlockMatrix& A) const {
  if (stiffness_factor == 0.0) return;
  COXA_ASSERT(impl_->time_step > 0.0);
  const auto part = std::make_unique_for_overwrite<Mat3[]>(impl_->scatter.n_blocks());
  parallel_for(impl_->n_elements(), [&](Index e) {
    impl_->element_blocks(x, e, stiffness_factor, &part[impl_->scatter.block(e)]);
  });
  impl_->scatter.gather_blocks(part.get(), A);
}

VecX PoreFluid::pressure(const VecX& x) const {
  VecX pressure(impl_->rest.rows());
  const auto at_corner = [&](Index node) {
    const Index particle = impl_->pressure_of[static_cast<Size>(node)];
    return particle < 0 ? kNaN : impl_->options.pressure_unit * x[3 * Eigen::Index{particle}];
  };
  for (Index i = 0; i < static_cast<Index>(pressure.size()); ++i) {
    const auto [a, b] = impl_->mid_ends[static_cast<Size>(i)];
    pressure[i] = a < 0 ? at_corner(i) : 0.5 * (at_corner(a) + at_corner(b));
  }
  return pressure;
}

double PoreFluid::outflow(const VecX& x) const {
  VecX force = VecX::Zero(3 * Eigen::Index{n_particles()});
  add_force(x, VecX(), force);
  // free pressures are in balance; what is left at held ones went through them
  double sum = 0.0;
  for (const Index particle : impl_->pressure_of)
    if (particle >= 0) sum -= force[3 * Eigen::Index{particle}];
  return sum / impl_->options.pressure_unit;
}

double PoreFluid::volume(const VecX& x) const {
  return parallel_reduce(
      impl_->n_elements(), 0.0,
      [&](Index e) {
        double sum = 0.0;
        for (int q = 0; q < impl_->n_points; ++q)
          sum += impl_->points[impl_->point_number(e, q)].weight *
                 impl_->gradient_of(x, e, q).determinant();
        return sum;
      },
      [](double a, double b) { return a + b; });
}

Points PoreFluid::flow(const VecX& x) const {
  Points flow = Points::Zero(impl_->n_elements(), 3);
  parallel_for(impl_->n_elements(), [&](Index e) {
    const Eigen::Vector4d p = impl_->corner_pressures(x, e);
    for (int q = 0; q < impl_->n_points; ++q) {
      const Impl::Point& point = impl_->points[impl_->point_number(e, q)];
      flow.row(e) -=
          (point.spatial_mobility * Impl::pressure_slope(point, p)).transpose() / impl_->n_points;
    }
  });
  return flow;
}

}  // namespace coxa::fem
