#include <coxa/fem/sphere_contact.h>

#include <coxa/core/error.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>

namespace coxa::fem {
namespace {

constexpr int kPoints = 7;

/// Barycentric coordinates and weights of the seven-point rule, exact to degree 5 (Radon 1948).
struct Rule {
  Eigen::Matrix<double, kPoints, 3> at;
  std::array<double, kPoints> weight;
};

Rule seven_points() {
  const double root = std::sqrt(15.0);
  const double a = (6.0 - root) / 21.0, b = (6.0 + root) / 21.0;
  const double wa = (155.0 - root) / 1200.0, wb = (155.0 + root) / 1200.0;
  Rule rule;
  rule.at << 1.0 / 3, 1.0 / 3, 1.0 / 3, a, a, 1 - 2 * a, a, 1 - 2 * a, a, 1 - 2 * a, a, a, b, b,
      1 - 2 * b, b, 1 - 2 * b, b, 1 - 2 * b, b, b;
  rule.weight = {0.225, wa, wa, wa, wb, wb, wb};
  return rule;
}

/// Shape functions at the points, 7 × 3 or 7 × 6, and their derivatives by the first two
/// coordinates.
MatX shape_values(const Rule& rule, Eigen::Index n) {
  if (n == 3) return rule.at;
  MatX N(kPoints, 6);
  for (int q = 0; q < kPoints; ++q)
    for (int i = 0; i < 3; ++i) {
      const double L = rule.at(q, i), next = rule.at(q, (i + 1) % 3);
      N(q, i) = L * (2.0 * L - 1.0);
      N(q, 3 + i) = 4.0 * L * next;
    }
  return N;
}

/// dX along the first two barycentric coordinates at point q of a face with nodes X (3 × n).
Eigen::Matrix<double, 3, 2> tangents(const Rule& rule, int q, const Eigen::Matrix3Xd& X) {
  Eigen::Matrix3d along;  // dX / dL
  if (X.cols() == 3) {
    along = X;
  } else {
    for (int i = 0; i < 3; ++i) {
      const int next = (i + 1) % 3, before = (i + 2) % 3;
      along.col(i) = (4.0 * rule.at(q, i) - 1.0) * X.col(i) +
                     4.0 * rule.at(q, next) * X.col(3 + i) +
                     4.0 * rule.at(q, before) * X.col(3 + before);
    }
  }
  Eigen::Matrix<double, 3, 2> dX;
  dX << along.col(0) - along.col(2), along.col(1) - along.col(2);
  return dX;
}

}  // namespace

SphereContact::SphereContact(ContactFaces faces, const VecX& rest, const RigidSphere& sphere,
                             double stiffness)
    : faces_(std::move(faces)), sphere_(sphere), stiffness_(stiffness) {
  require(faces_.cols() == 3 || faces_.cols() == 6, "contact faces have 3 or 6 nodes, got ",
          faces_.cols());
  require(stiffness > 0.0, "the penalty stiffness must be positive, got ", stiffness, " MPa/mm");
  require(sphere.radius > 0.0, "the sphere's radius must be positive, got ", sphere.radius, " mm");
  const Rule rule = seven_points();
  shape_ = shape_values(rule, faces_.cols());
  Eigen::Matrix3Xd X(3, faces_.cols());
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    for (Eigen::Index a = 0; a < faces_.cols(); ++a) X.col(a) = rest.segment<3>(3 * faces_(f, a));
    for (int q = 0; q < kPoints; ++q) {
      const auto dX = tangents(rule, q, X);
      weight_.push_back(0.5 * rule.weight[static_cast<std::size_t>(q)] *
                        dX.col(0).cross(dX.col(1)).norm());
    }
  }
}

SphereContact::Point SphereContact::point(const VecX& x, Index face, int q) const {
  Vec3 position = Vec3::Zero();
  for (Eigen::Index a = 0; a < faces_.cols(); ++a)
    position += shape_(q, a) * x.segment<3>(3 * faces_(face, a));
  const Vec3 out = position - sphere_.centre;
  const double distance = out.norm();
  return {position, out / distance, distance - sphere_.radius};
}

std::vector<std::pair<Index, Index>> SphereContact::pattern() const {
  std::vector<std::pair<Index, Index>> pairs;
  for (Eigen::Index f = 0; f < faces_.rows(); ++f)
    for (Eigen::Index a = 0; a < faces_.cols(); ++a)
      for (Eigen::Index b = 0; b < faces_.cols(); ++b)
        pairs.emplace_back(faces_(f, a), faces_(f, b));
  return pairs;
}

void SphereContact::add_force(const VecX& x, const VecX&, VecX& force) const {
  for (Index f = 0; f < static_cast<Index>(faces_.rows()); ++f)
    for (int q = 0; q < kPoints; ++q) {
      const Point p = point(x, f, q);
      if (p.gap >= 0.0) continue;
      const double size = -stiffness_ * p.gap * weight_[static_cast<std::size_t>(kPoints * f + q)];
      for (Eigen::Index a = 0; a < faces_.cols(); ++a)
        force.segment<3>(3 * faces_(f, a)) += size * shape_(q, a) * p.normal;
    }
}

void SphereContact::add_jacobian(const VecX& x, const VecX&, double stiffness_factor, double,
                                 solve::BlockMatrix& A) const {
  if (stiffness_factor == 0.0) return;
  for (Index f = 0; f < static_cast<Index>(faces_.rows()); ++f)
    for (int q = 0; q < kPoints; ++q) {
      const Point p = point(x, f, q);
      if (p.gap >= 0.0) continue;
      const Mat3 nn = p.normal * p.normal.transpose();
      const Mat3 block = stiffness_factor * stiffness_ *
                         weight_[static_cast<std::size_t>(kPoints * f + q)] *
                         (nn + p.gap / (p.gap + sphere_.radius) * (Mat3::Identity() - nn));
      for (Eigen::Index a = 0; a < faces_.cols(); ++a)
        for (Eigen::Index b = 0; b < faces_.cols(); ++b)
          A.at(faces_(f, a), faces_(f, b)) += shape_(q, a) * shape_(q, b) * block;
    }
}

double SphereContact::energy(const VecX& x) const {
  double sum = 0.0;
  for (Index f = 0; f < static_cast<Index>(faces_.rows()); ++f)
    for (int q = 0; q < kPoints; ++q) {
      const double gap = point(x, f, q).gap;
      if (gap < 0.0)
        sum += 0.5 * stiffness_ * gap * gap * weight_[static_cast<std::size_t>(kPoints * f + q)];
    }
  return sum;
}

Vec3 SphereContact::resultant(const VecX& x) const {
  Vec3 sum = Vec3::Zero();
  for (Index f = 0; f < static_cast<Index>(faces_.rows()); ++f)
    for (int q = 0; q < kPoints; ++q) {
      const Point p = point(x, f, q);
      if (p.gap < 0.0)
        sum -= stiffness_ * p.gap * weight_[static_cast<std::size_t>(kPoints * f + q)] * p.normal;
    }
  return sum;
}

double SphereContact::pressure_at(const Vec3& position) const {
  return std::max(0.0, stiffness_ * (sphere_.radius - (position - sphere_.centre).norm()));
}

}  // namespace coxa::fem
