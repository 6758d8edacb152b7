#include <coxa/motion/estimated_centre.h>

#include <coxa/core/error.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace coxa::motion {
namespace {

constexpr double kHalfWidth = 1.96;

double towards(Side side) { return side == Side::right ? 1.0 : -1.0; }

// rows of `trajectory` that were seen
Points seen_rows(const Points& trajectory) {
  std::vector<Index> rows;
  for (Index k = 0; k < trajectory.rows(); ++k) {
    if (trajectory.row(k).allFinite()) rows.push_back(k);
  }
  return trajectory(rows, Eigen::all);
}

// a movement about one axis leaves the centre free along it
void check_condition(const Mat3& A) {
  const Vec3 values = Eigen::SelfAdjointEigenSolver<Mat3>(A).eigenvalues();
  require(values[0] > 1e-4 * values[2],
          "the movement turns about one axis only: the joint centre cannot be found along it; ",
          "record flexion and abduction, or circumduction");
}

}  // namespace

JointCentre harrington_centre(double pelvis_width, double pelvis_depth, Side side) {
  require(pelvis_width > 50 && pelvis_depth > 20, "pelvis width ", pelvis_width, " mm and depth ",
          pelvis_depth, " mm are no person's");
  JointCentre result;
  result.definition = "harrington";
  result.region = "regression on pelvis width and depth (Harrington 2007)";
  result.centre = Vec3(-0.24 * pelvis_depth - 9.9, -0.30 * pelvis_width - 10.9,
                       towards(side) * (0.33 * pelvis_width + 7.3));
  // error vector of 12.3 mm mean and 5.9 mm spread, shared by three coordinates
  result.interval = kHalfWidth * std::hypot(12.3, 5.9) / std::sqrt(3.0);
  return result;
}

JointCentre bell_centre(double pelvis_width, Side side) {
  require(pelvis_width > 50, "pelvis width ", pelvis_width, " mm is no person's");
  JointCentre result;
  result.definition = "bell";
  result.region = "regression on pelvis width (Bell 1989)";
  result.centre =
      Vec3(-0.22 * pelvis_width, -0.30 * pelvis_width, towards(side) * (0.5 - 0.14) * pelvis_width);
  // predictive methods against dual fluoroscopy: 18.1 mm mean, 9.5 mm spread
  result.interval = kHalfWidth * std::hypot(18.1, 9.5) / std::sqrt(3.0);
  return result;
}

JointCentre score_centre(const std::vector<RigidTransform>& X_LP,
                         const std::vector<RigidTransform>& X_LF) {
  require(X_LP.size() == X_LF.size() && X_LP.size() >= 10,
          "the functional joint centre needs the same 10 or more frames of both segments, got ",
          X_LP.size(), " and ", X_LF.size());
  // normal equations of [R_P, -R_F] [c_P; c_F] = p_F - p_P
  using Mat6 = Eigen::Matrix<double, 6, 6>;
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  Mat6 A = Mat6::Zero();
  Vec6 b = Vec6::Zero();
  for (std::size_t k = 0; k < X_LP.size(); ++k) {
    Eigen::Matrix<double, 3, 6> J;
    J << X_LP[k].R, -X_LF[k].R;
    A += J.transpose() * J;
    b += J.transpose() * (X_LF[k].p - X_LP[k].p);
  }
  const auto n = static_cast<double>(X_LP.size());
  const Mat3 coupling = A.topRightCorner<3, 3>() / n;
  check_condition(Mat3::Identity() - coupling * coupling.transpose());
  const Vec6 c = A.ldlt().solve(b);
  double squares = 0.0;
  for (std::size_t k = 0; k < X_LP.size(); ++k)
    squares += (X_LP[k] * Vec3(c.head<3>()) - X_LF[k] * Vec3(c.tail<3>())).squaredNorm();
  JointCentre result;
  result.definition = "score";
  result.region = join_text("SCoRE over ", X_LP.size(), " frames");
  result.centre = c.head<3>();
  result.rms = std::sqrt(squares / n);
  // functional centres from skin markers against dual fluoroscopy: 11.0 mm mean, 3.3 mm spread
  result.interval = kHalfWidth * std::hypot(11.0, 3.3) / std::sqrt(3.0);
  return result;
}

Vec3 gamage_lasenby_centre(const std::vector<Points>& trajectories) {
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  for (const Points& trajectory : trajectories) {
    const Points v = seen_rows(trajectory);
    if (v.rows() < 4) continue;
    const auto n = static_cast<double>(v.rows());
    const Vec3 mean = v.colwise().mean();
    const VecX square = v.rowwise().squaredNorm();
    A += 2.0 * (v.transpose() * v / n - mean * mean.transpose());
    b += v.transpose() * square / n - mean * square.mean();
  }
  require(A.squaredNorm() > 0, "no marker is seen in four frames");
  check_condition(A);
  return A.ldlt().solve(b);
}

JointCentre sphere_centre(const std::vector<Points>& trajectories) {
  std::vector<Points> seen;
  for (const Points& trajectory : trajectories) {
    Points v = seen_rows(trajectory);
    if (v.rows() >= 4) seen.push_back(std::move(v));
  }
  Vec3 c = gamage_lasenby_centre(seen);
  // Gauss-Newton on |v - c| - r, the radii eliminated as the mean distance of each marker
  Mat3 A = Mat3::Identity();
  double squares = 0.0, count = 0.0;
  for (int iteration = 0; iteration < 50; ++iteration) {
    A.setZero();
    Vec3 b = Vec3::Zero();
    squares = count = 0.0;
    for (const Points& v : seen) {
      const Points d = v.rowwise() - c.transpose();
      const VecX distance = d.rowwise().norm();
      const Points u = d.array().colwise() / distance.array();
      const Points J = -(u.rowwise() - u.colwise().mean());
      const VecX r = distance.array() - distance.mean();
      A += J.transpose() * J;
      b += J.transpose() * r;
      squares += r.squaredNorm();
      count += static_cast<double>(r.size());
    }
    const Vec3 step = -A.ldlt().solve(b);
    c += step;
    if (step.norm() < 1e-9) break;
  }
  JointCentre result;
  result.definition = "functional_sphere";
  result.region = join_text("spheres of ", seen.size(), " markers about one centre");
  result.centre = c;
  result.rms = std::sqrt(squares / std::max(1.0, count));
  result.interval = kHalfWidth * std::hypot(11.0, 3.3) / std::sqrt(3.0);
  return result;
}

}  // namespace coxa::motion
