#include "level_forces.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>

#include <Eigen/Geometry>

namespace coxa::segment {
namespace {

/// Share of the image force's stiffness that acts across the normal: the image says nothing there,
/// but the affine part of the field does.
constexpr double kTangentialImage = 0.1;

/// Metric parameters of an even mesh are about 1/3; beyond this size the foot lies far outside the
/// triangle.
constexpr double kLargestMetric = 1.0;

std::vector<double> simplex_angles(const Points& p, const Triangles& neighbours) {
  std::vector<double> angles(static_cast<std::size_t>(p.rows()));
  parallel_for(p.rows(), [&](Index v) {
    angles[static_cast<std::size_t>(v)] =
        simplex_angle(p.row(v).transpose(), p.row(neighbours(v, 0)).transpose(),
                      p.row(neighbours(v, 1)).transpose(), p.row(neighbours(v, 2)).transpose());
  });
  return angles;
}

}  // namespace

LevelForces::LevelForces(const Body& body, std::size_t level, Index first)
    : level_(level),
      first_(first),
      mesh_(body.model->hierarchy.levels[level]),
      image_(first),
      shape_(first),
      seat_(first),
      smoothing_(first, mesh_.neighbours),
      memory_(first, mesh_.neighbours) {}

std::vector<const dynamics::Force*> LevelForces::forces() const {
  return {&image_, &shape_, &seat_, &smoothing_, &memory_};
}

void LevelForces::prepare(const Body& body, const Points& positions, const Points& field,
                          const ForceWeights& weights, const TriMesh& host, double seat_gap) {
  const SimplexHierarchy& hierarchy = body.model->hierarchy;
  mesh_.points = positions;
  const Points normals = simplex_normals(mesh_);
  const VecX& confidence = body.match.confidence;

  const Points asked = field_at_level(hierarchy, level_, field, confidence);
  const VecX trust = weights.image * values_at_level(hierarchy, level_, confidence);
  image_.prepare(positions + asked, trust, normals, kTangentialImage);

  const Points fit = level_points(hierarchy, level_, body.fit.points, body.fit.pose);
  // where the image is sure the model steps back: few examples do not describe everybody's bone
  const VecX doubt = 1.0 - values_at_level(hierarchy, level_, confidence).array().min(1.0);
  shape_.prepare(fit, weights.shape * doubt, normals, 1.0);
  prepare_internal(fit, weights);
  prepare_seat(body, normals, weights, host, seat_gap);
}

void LevelForces::prepare_internal(const Points& fit, const ForceWeights& weights) {
  const Points& x = mesh_.points;
  const Triangles& around = mesh_.neighbours;
  const std::vector<double> now = simplex_angles(x, around), model = simplex_angles(fit, around);
  Points metric(n(), 3), remembered(n(), 3), smooth(n(), 3);
  parallel_for(n(), [&](Index v) {
    const auto corner = [&](const Points& p, int k) -> Vec3 {
      return p.row(around(v, k)).transpose();
    };
    const SimplexParameters form =
        simplex_parameters(fit.row(v).transpose(), corner(fit, 0), corner(fit, 1), corner(fit, 2));
    if (form.metric.cwiseAbs().maxCoeff() > kLargestMetric) {
      // on a knife edge the neighbours' triangle does not describe the vertex: its place in the fit
      // does
      metric.row(v).setConstant(1.0 / 3.0);
      const Vec3 centre = (corner(fit, 0) + corner(fit, 1) + corner(fit, 2)) / 3.0;
      remembered.row(v) = fit.row(v) - centre.transpose();
      smooth.row(v) = remembered.row(v);
      return;
    }
    const Vec3 A = corner(x, 0), B = corner(x, 1), C = corner(x, 2);
    const Vec3 foot = form.metric[0] * A + form.metric[1] * B + form.metric[2] * C;
    const Vec3 by_form = position_from(form, A, B, C);
    // the angle's deviation from the model is the mean of the neighbours' deviations
    double deviation = 0.0;
    for (int k = 0; k < 3; ++k) {
      const auto u = static_cast<std::size_t>(around(v, k));
      deviation += (now[u] - model[u]) / 3.0;
    }
    const double phi = model[static_cast<std::size_t>(v)] + deviation;
    const Vec3 n = (B - A).cross(C - A).normalized();
    const Vec3 by_angle = position_from_angle(form.metric, phi, (by_form - foot).dot(n), A, B, C);
    metric.row(v) = form.metric.transpose();
    remembered.row(v) = (by_form - foot).transpose();
    smooth.row(v) = (by_angle - foot).transpose();
  });
  memory_.prepare(metric, std::move(remembered), weights.memory);
  smoothing_.prepare(std::move(metric), std::move(smooth), weights.smoothing);
}

void LevelForces::prepare_seat(const Body& body, const Points& normals, const ForceWeights& weights,
                               const TriMesh& host, double seat_gap) {
  Points targets = mesh_.points, directions = normals;
  VecX stiffness = VecX::Zero(n());
  if (!host.empty() && body.seat.size() > 0) {
    const TriangleTree tree(host.points, host.triangles);
    const VecX seated = values_at_level(body.model->hierarchy, level_, body.seat);
    parallel_for(n(), [&](Index v) {
      if (seated[v] < 0.5) return;
      const Vec3 p = mesh_.points.row(v).transpose();
      const NearestPoint near = tree.nearest(p);
      const Eigen::Matrix<Index, 1, 3> t = host.triangles.row(near.triangle);
      const Vec3 a = host.points.row(t[0]).transpose(), b = host.points.row(t[1]).transpose(),
                 c = host.points.row(t[2]).transpose();
      const Vec3 outward = (b - a).cross(c - a).normalized();
      targets.row(v) = (near.point + seat_gap * outward).transpose();
      directions.row(v) = outward.transpose();
      stiffness[v] = weights.contact;
    });
  }
  seat_.prepare(std::move(targets), stiffness, directions, 0.0);
}

}  // namespace coxa::segment
