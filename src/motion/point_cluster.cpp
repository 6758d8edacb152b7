#include <coxa/core/parallel.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>

#include "thigh_observations.h"

// Andriacchi et al. 1998, J Biomech Eng 120:743-749: the cluster's principal axes carry the bone;
// the markers' masses are adjusted so that its principal moments keep their reference values.
namespace coxa::motion {
namespace {

struct Axes {
  Vec3 centre, moments;  // moments ascending
  Mat3 R;                // columns: principal axes, right-handed, signs free
};

Axes principal_axes(const Points& p, const VecX& mass) {
  Axes axes;
  axes.centre = p.transpose() * mass / mass.sum();
  const Points d = p.rowwise() - axes.centre.transpose();
  const Mat3 second = d.transpose() * mass.asDiagonal() * d;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(second.trace() * Mat3::Identity() - second);
  axes.moments = eigen.eigenvalues();
  axes.R = eigen.eigenvectors();
  if (axes.R.determinant() < 0) axes.R.col(2) = -axes.R.col(2);
  return axes;
}

// derivative of the principal moments by the masses, 3×n; the centre's part vanishes to first order
MatX moment_derivative(const Points& p, const Axes& axes) {
  const MatX along = (p.rowwise() - axes.centre.transpose()) * axes.R;
  const VecX square = along.rowwise().squaredNorm();
  MatX derivative(3, p.rows());
  for (int k = 0; k < 3; ++k) derivative.row(k) = (square - along.col(k).cwiseAbs2()).transpose();
  return derivative;
}

// smallest change of the masses that restores the moments (Gauss-Newton, masses stay positive)
VecX adjusted_masses(const Points& p, const Vec3& moments) {
  constexpr int kSteps = 5;
  constexpr double kSmallestMass = 0.05;
  VecX mass = VecX::Ones(p.rows());
  for (int step = 0; step < kSteps; ++step) {
    const Axes axes = principal_axes(p, mass);
    const MatX derivative = moment_derivative(p, axes);
    mass += derivative.completeOrthogonalDecomposition().solve(moments - axes.moments);
    mass = mass.cwiseMax(kSmallestMass);
  }
  return mass;
}

// of the four right-handed sign choices the rotation nearest to `guess`
Mat3 nearest_sign_choice(const Mat3& axes_now, const Mat3& axes_reference, const Mat3& guess) {
  const std::array<Vec3, 4> signs = {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1),
                                     Vec3(-1, -1, 1)};
  Mat3 best = Mat3::Identity();
  double best_trace = -kInfinity;
  for (const Vec3& s : signs) {
    const Mat3 R = axes_now * s.asDiagonal() * axes_reference.transpose();
    const double trace = (R.transpose() * guess).trace();
    if (trace > best_trace) {
      best_trace = trace;
      best = R;
    }
  }
  return best;
}

}  // namespace

PoseEstimate estimate_point_cluster(const ThighObservations& thigh) {
  PoseEstimate estimate = estimate_rigid(thigh);  // settles the signs of the axes
  parallel_for(thigh.n_frames(), [&](Index frame) {
    const auto f = static_cast<std::size_t>(frame);
    if (!estimate.valid[f]) return;
    const std::vector<Index> markers = seen_markers(thigh, frame);
    const Points x = thigh.x(markers, Eigen::all), y = thigh.y[f](markers, Eigen::all);
    const Axes reference = principal_axes(x, VecX::Ones(x.rows()));
    const Axes now = principal_axes(y, adjusted_masses(y, reference.moments));
    estimate.R_PF[f] = nearest_sign_choice(now.R, reference.R, estimate.R_PF[f]);
    estimate.head[f] = now.centre - estimate.R_PF[f] * reference.centre;
  });
  return estimate;
}

}  // namespace coxa::motion
