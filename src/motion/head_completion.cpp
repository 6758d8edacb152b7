#include "head_completion.h"

#include <coxa/core/error.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace coxa::motion {
namespace {

// what the harmonics leave of a head, alike over patches of its surface: their area counts as one
// observation
constexpr double kLeft = 0.2;     // mm, standard deviation
constexpr double kPatch = 100.0;  // mm²
constexpr Index kDirections = 300;

// a head as a sphere and its departures from it
struct ShapedHead {
  Sphere sphere;
  VecX shape;       // of the harmonics
  MatX covariance;  // of centre (mm), radius (mm), shape
  Mat3 axes;        // of the head
  Points seen;      // directions in view from the centre, unit
};

// precision of the shape a priori
VecX prior_precision(const HeadShape& shape) {
  VecX precision(shape.mean.size());
  Eigen::Index k = 0;
  for (Index degree = 2; degree <= shape.degree; ++degree) {
    for (Index order = 0; order < 2 * degree + 1; ++order)
      precision[k++] = 1.0 / std::pow(shape.spread[degree - 2], 2);
  }
  return precision;
}

// derivative of radial residuals by centre, radius and shape, at directions from the centre
MatX radial_derivative(const Points& directions, const MatX& harmonics, const ShapedHead& head) {
  MatX J(directions.rows(), 4 + harmonics.cols());
  J.leftCols<3>() = -directions;
  J.col(3) = -(VecX::Ones(directions.rows()) + harmonics * head.shape);
  J.rightCols(harmonics.cols()) = -head.sphere.radius * harmonics;
  return J;
}

// Gauss-Newton with the region and the weights chosen anew in every round
ShapedHead most_probable_head(const SurfaceSamples& samples, const Sphere& first,
                              const HeadPrior& prior, const JointCentreOptions& options) {
  constexpr int kRounds = 20;
  constexpr double kBand = 2.5, kStill = 1e-4;  // mm
  const VecX precision = prior_precision(prior.shape);
  ShapedHead head{first, prior.shape.mean, {}, Mat3::Identity(), {}};
  for (int round = 0; round < kRounds; ++round) {
    const Vec3 neck = neck_direction(samples, head.sphere.centre, head.sphere.radius);
    const RegionRule rule{.band = kBand, .neck = neck, .neck_cosine = std::cos(options.neck_cone)};
    const std::vector<Index> region = find_region(samples, head.sphere, rule);
    head.axes = head_axes(neck, prior.side);
    const Points arms =
        samples.points(region, Eigen::all).rowwise() - head.sphere.centre.transpose();
    const VecX distances = arms.rowwise().norm();
    head.seen = arms.array().colwise() / distances.array();
    const MatX Y = head_harmonics(head.seen * head.axes, prior.shape.degree);
    const MatX J = radial_derivative(head.seen, Y, head);
    const VecX residuals = distances + head.sphere.radius * J.col(3);
    const VecX weights =
        tukey_weights(residuals, options.outlier_scale).cwiseProduct(samples.areas(region)) /
        (kPatch * kLeft * kLeft);
    MatX information = J.transpose() * weights.asDiagonal() * J;
    VecX gradient = J.transpose() * weights.cwiseProduct(residuals);
    information.bottomRightCorner(Y.cols(), Y.cols()).diagonal() += precision;
    gradient.tail(Y.cols()) += precision.cwiseProduct(head.shape - prior.shape.mean);
    const Eigen::LDLT<MatX> solver(information);
    const VecX step = -solver.solve(gradient);
    head.sphere.centre += step.head<3>();
    head.sphere.radius += step[3];
    head.shape += step.tail(Y.cols());
    head.covariance = solver.solve(MatX::Identity(step.size(), step.size()));
    if (step.head<4>().norm() < kStill) break;
  }
  return head;
}

struct Gaps {
  Points directions;   // off the neck with no bone within 10 degrees, in the head's axes
  double share = 0.0;  // of all directions off the neck
};

// a bump or a fovea is in view, though the sphere leaves it out
Gaps gaps_in_view(const SurfaceSamples& samples, const ShapedHead& head, double neck_cone) {
  constexpr double kReach = 6.0;  // mm about the radius
  const double near = std::cos(radians(10.0));
  const Points arms = samples.points.rowwise() - head.sphere.centre.transpose();
  const VecX distances = arms.rowwise().norm();
  std::vector<Index> bone;
  for (Index k = 0; k < arms.rows(); ++k) {
    if (std::abs(distances[k] - head.sphere.radius) < kReach) bone.push_back(k);
  }
  const Points seen = arms(bone, Eigen::all).rowwise().normalized() * head.axes;
  const Points directions = spiral_directions(kDirections);
  std::vector<Index> missing;
  double all = 0.0;
  for (Index k = 0; k < kDirections; ++k) {
    if (directions(k, 2) > std::cos(neck_cone)) continue;
    all += 1.0;
    if ((seen * directions.row(k).transpose()).maxCoeff() < near) missing.push_back(k);
  }
  return {directions(missing, Eigen::all), static_cast<double>(missing.size()) / all};
}

// how the uncertain centre, radius and shape of the added part move the sphere of the whole head
double centre_deviation(const ShapedHead& head, const VecX& seen_areas,
                        const MatX& added_derivative, double added_area) {
  Eigen::Matrix<double, Eigen::Dynamic, 4> S(head.seen.rows(), 4);
  S << head.seen, VecX::Ones(head.seen.rows());
  Eigen::Matrix<double, Eigen::Dynamic, 4> A(added_derivative.rows(), 4);
  A << -added_derivative.leftCols<3>(), VecX::Ones(added_derivative.rows());
  const Eigen::Matrix4d information =
      S.transpose() * seen_areas.asDiagonal() * S + added_area * A.transpose() * A;
  const MatX gain = information.ldlt().solve(added_area * A.transpose() * -added_derivative);
  const MatX covariance = gain * head.covariance * gain.transpose();
  return std::sqrt(covariance.diagonal().head<3>().maxCoeff());
}

void append(SurfaceSamples& samples, const Points& points, const Points& normals, double area) {
  const Eigen::Index n = samples.points.rows(), m = points.rows();
  samples.points.conservativeResize(n + m, 3);
  samples.normals.conservativeResize(n + m, 3);
  samples.areas.conservativeResize(n + m);
  samples.points.bottomRows(m) = points;
  samples.normals.bottomRows(m) = normals;
  samples.areas.tail(m).setConstant(area);
}

}  // namespace

Mat3 head_axes(const Vec3& neck, Side side) {
  const Vec3 up = Vec3::UnitZ() - neck.z() * neck;
  require(up.norm() > 0.1, "the femoral neck runs straight up or down: is the surface in LPS?");
  const Vec3 y = up.normalized();
  Mat3 axes;
  axes << (side == Side::right ? Vec3(y.cross(neck)) : Vec3(neck.cross(y))), y, neck;
  return axes;
}

CompletedHead complete_head(const SurfaceSamples& samples, const RegionFit& seen,
                            const HeadPrior& prior, const JointCentreOptions& options) {
  constexpr double kWhole = 0.97, kPart = 0.85;  // of the directions off the neck
  check_head_shape(prior.shape);
  CompletedHead completed{samples};
  const ShapedHead head = most_probable_head(samples, seen.sphere, prior, options);
  const Gaps gaps = gaps_in_view(samples, head, options.neck_cone);
  const double weight = std::clamp((kWhole - 1.0 + gaps.share) / (kWhole - kPart), 0.0, 1.0);
  if (weight == 0) return completed;
  const double radius = head.sphere.radius;
  const double area = weight * 4.0 * kPi * radius * radius / kDirections;
  const MatX Y = head_harmonics(gaps.directions, prior.shape.degree);
  const Points outward = gaps.directions * head.axes.transpose();
  const VecX distances = radius * (VecX::Ones(Y.rows()) + Y * head.shape);
  Points points = outward.array().colwise() * distances.array();
  points.rowwise() += head.sphere.centre.transpose();
  append(completed.samples, points, outward, area);
  completed.added_share = gaps.share;
  const double per_sample =
      4.0 * kPi * radius * radius * (1.0 - gaps.share) / static_cast<double>(head.seen.rows());
  completed.centre_sd = centre_deviation(head, VecX::Constant(head.seen.rows(), per_sample),
                                         radial_derivative(outward, Y, head), area);
  return completed;
}

}  // namespace coxa::motion
