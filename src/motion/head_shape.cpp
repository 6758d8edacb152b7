#include <coxa/motion/head_shape.h>

#include <coxa/core/error.h>
#include <coxa/motion/joint_centre.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "head_completion.h"

namespace coxa::motion {
namespace {

// Part of the examples' mean that is believed of other people: heads of other sources show less of
// it than those it was learned from do of each other's.
constexpr double kBelieved = 0.5;

Index coefficient_count(Index degree) { return (degree + 1) * (degree + 1) - 4; }

// associated Legendre functions of one order at z for degrees order to `degree`, without the
// Condon-Shortley sign
VecX legendre(Index order, Index degree, double z) {
  VecX values(degree - order + 1);
  double top = 1.0;
  for (Index k = 1; k <= order; ++k) top *= (2 * k - 1) * std::sqrt(std::max(0.0, 1.0 - z * z));
  values[0] = top;
  if (degree > order) values[1] = z * (2 * order + 1) * top;
  for (Index l = order + 2; l <= degree; ++l) {
    values[l - order] =
        (z * (2 * l - 1) * values[l - order - 1] - (l + order - 1) * values[l - order - 2]) /
        (l - order);
  }
  return values;
}

// makes a harmonic's mean square over the sphere 1
double norm_of(Index degree, Index order) {
  double ratio = 1.0;
  for (Index k = degree - order + 1; k <= degree + order; ++k) ratio /= k;
  return std::sqrt((order == 0 ? 1.0 : 2.0) * (2 * degree + 1) * ratio);
}

// harmonics of one head, least squares over its off-neck region; high degrees, which the neck's
// side leaves open, are held near zero
VecX shape_of(const HeadExample& example, Index degree) {
  constexpr double kHeld = 0.01;
  const JointCentreOptions options;
  const SurfaceSamples samples = surface_samples(example.femur);
  const auto start = find_head(samples, options.smallest_radius, options.largest_radius);
  require(start.has_value(), "no head is found on a femur that heads are to be learned from");
  const RegionFit fit = fit_off_neck(samples, first_sphere(samples, *start), options);
  const Points arms =
      samples.points(fit.region, Eigen::all).rowwise() - fit.sphere.centre.transpose();
  const VecX distances = arms.rowwise().norm();
  const Mat3 axes =
      head_axes(neck_direction(samples, fit.sphere.centre, fit.sphere.radius), example.side);
  const Points directions = arms.array().colwise() / distances.array();
  const MatX Y = head_harmonics(directions * axes, degree);
  const VecX off = distances / fit.sphere.radius - VecX::Ones(distances.size());
  const VecX weights =
      tukey_weights(off, options.outlier_scale).cwiseProduct(samples.areas(fit.region));
  MatX information = Y.transpose() * weights.asDiagonal() * Y / weights.sum();
  Eigen::Index k = 0;
  for (Index l = 2; l <= degree; ++l) {
    for (Index order = 0; order < 2 * l + 1; ++order, ++k)
      information(k, k) += kHeld * std::pow(0.5 * l, 4);
  }
  return information.ldlt().solve(Y.transpose() * weights.cwiseProduct(off) / weights.sum());
}

}  // namespace

void check_head_shape(const HeadShape& shape) {
  require(shape.degree >= 2 && shape.mean.size() == coefficient_count(shape.degree) &&
              shape.spread.size() == shape.degree - 1,
          "a head's shape of degree ", shape.degree, " needs (degree + 1)² - 4 mean coefficients",
          " and degree - 1 spreads, got ", shape.mean.size(), " and ", shape.spread.size());
  require(shape.spread.minCoeff() > 0, "the spreads of a head's shape must be above 0");
}

MatX head_harmonics(const Points& directions, Index degree) {
  MatX Y(directions.rows(), coefficient_count(degree));
  for (Eigen::Index row = 0; row < directions.rows(); ++row) {
    const double turn = std::atan2(directions(row, 1), directions(row, 0));
    for (Index order = 0; order <= degree; ++order) {
      const VecX P = legendre(order, degree, directions(row, 2));
      for (Index l = std::max<Index>(2, order); l <= degree; ++l) {
        const double value = norm_of(l, order) * P[l - order];
        const Index first = l * l - 4;  // of this degree
        if (order == 0) {
          Y(row, first) = value;
        } else {
          Y(row, first + 2 * order - 1) = value * std::cos(order * turn);
          Y(row, first + 2 * order) = value * std::sin(order * turn);
        }
      }
    }
  }
  return Y;
}

HeadShape learn_head_shape(const std::vector<HeadExample>& examples, Index degree) {
  require(examples.size() >= 2, "heads are learned from two femora at least, got ",
          examples.size());
  require(degree >= 2, "the degree of a head's shape must be 2 at least, got ", degree);
  const auto n = static_cast<Eigen::Index>(examples.size());
  MatX shapes(n, coefficient_count(degree));
  for (Eigen::Index k = 0; k < n; ++k)
    shapes.row(k) = shape_of(examples[static_cast<std::size_t>(k)], degree).transpose();
  const VecX mean = shapes.colwise().mean().transpose();
  HeadShape shape{degree, kBelieved * mean, VecX(degree - 1), {}};
  const VecX variance = (shapes.rowwise() - mean.transpose()).colwise().squaredNorm() /
                        (static_cast<double>(n) - 1.0);
  for (Index l = 2; l <= degree; ++l)
    shape.spread[l - 2] = std::sqrt(variance.segment(l * l - 4, 2 * l + 1).mean());
  return shape;
}

}  // namespace coxa::motion
