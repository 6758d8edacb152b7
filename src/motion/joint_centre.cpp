#include <coxa/motion/joint_centre.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "sphere_region.h"

namespace coxa::motion {
namespace {

const TriMesh* find_mesh(const SurfaceSet& surfaces, const char* name) {
  const auto it = surfaces.find(name);
  return it == surfaces.end() || it->second.mesh.empty() ? nullptr : &it->second.mesh;
}

JointCentre named(JointCentre centre, const char* definition, const char* region) {
  centre.definition = definition;
  centre.region = region;
  return centre;
}

// poses of the examination: each axis there and back, and the neutral pose
std::vector<Mat3> examination_rotations() {
  std::vector<Mat3> rotations = {Mat3::Identity()};
  for (const double angle : {radians(15.0), radians(30.0)}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0})
        rotations.push_back(rotation_from_vector(sign * angle * Vec3::Unit(axis)));
    }
  }
  return rotations;
}

// points spread evenly over the socket's articular surface: every triangle's centre, thinned by
// area
Points spread_samples(const TriMesh& mesh, Index wanted) {
  const VecX areas = triangle_areas(mesh);
  const double step = areas.sum() / wanted;
  std::vector<Vec3> chosen;
  double carried = 0.5 * step;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    carried += areas[t];
    if (carried < step) continue;
    carried = std::fmod(carried, step);
    chosen.push_back(mesh.points(mesh.triangles.row(t), Eigen::all).colwise().mean());
  }
  Points points(static_cast<Eigen::Index>(chosen.size()), 3);
  for (std::size_t k = 0; k < chosen.size(); ++k)
    points.row(static_cast<Eigen::Index>(k)) = chosen[k];
  return points;
}

// distance of every socket sample from the head in every pose about c, poses one after another;
// beyond `reach` (the head's surface has turned away from under the sample) NaN
VecX distances_about(const TriangleTree& head, const Points& samples,
                     const std::vector<Mat3>& rotations, const Vec3& c, double reach) {
  const auto n = static_cast<Index>(samples.rows());
  VecX distances(n * static_cast<Index>(rotations.size()));
  parallel_for(static_cast<Index>(distances.size()), [&](Index k) {
    const Vec3 p = samples.row(k % n);
    const Vec3 in_head = c + rotations[static_cast<std::size_t>(k / n)].transpose() * (p - c);
    const auto nearest = head.nearest_within(in_head, reach);
    distances[k] =
        nearest ? std::sqrt(nearest->squared_distance) * head.sign_at(in_head, *nearest) : kNaN;
  });
  return distances;
}

struct Spread {
  VecX deviations;  // from the mean of each pose; 0 where the head has turned away
  double mean_square = 0.0;
};

Spread deviations_of(const VecX& distances, Index n) {
  Spread spread{VecX::Zero(distances.size()), 0.0};
  double count = 0.0;
  for (Eigen::Index begin = 0; begin < distances.size(); begin += n) {
    double sum = 0.0, seen = 0.0;
    for (Eigen::Index k = begin; k < begin + n; ++k) {
      if (!std::isfinite(distances[k])) continue;
      sum += distances[k];
      seen += 1.0;
    }
    for (Eigen::Index k = begin; k < begin + n; ++k) {
      if (std::isfinite(distances[k])) spread.deviations[k] = distances[k] - sum / seen;
    }
    count += seen;
  }
  spread.mean_square = spread.deviations.squaredNorm() / std::max(1.0, count);
  return spread;
}

}  // namespace

JointCentre congruency_centre(const TriMesh& head, const TriMesh& socket, const Vec3& start,
                              Index n_samples) {
  constexpr double kReach = 8.0;        // mm
  constexpr double kDifference = 0.05;  // mm, for the derivative by central differences
  const TriangleTree tree(head.points, head.triangles);
  const Points samples = spread_samples(socket, n_samples);
  const auto n = static_cast<Index>(samples.rows());
  const std::vector<Mat3> rotations = examination_rotations();
  const auto spread_at = [&](const Vec3& c) {
    return deviations_of(distances_about(tree, samples, rotations, c, kReach), n);
  };

  // Gauss-Newton with a damping that grows until the variance falls
  Vec3 c = start;
  Spread now = spread_at(c);
  Mat3 information = Mat3::Identity();
  double damping = 1e-3;
  for (int iteration = 0; iteration < 20; ++iteration) {
    Eigen::Matrix<double, Eigen::Dynamic, 3> J(now.deviations.size(), 3);
    for (int k = 0; k < 3; ++k) {
      const Vec3 step = kDifference * Vec3::Unit(k);
      J.col(k) =
          (spread_at(c + step).deviations - spread_at(c - step).deviations) / (2.0 * kDifference);
    }
    information = J.transpose() * J;
    Mat3 damped = information;
    damped.diagonal() *= 1.0 + damping;
    const Vec3 step = -damped.ldlt().solve(J.transpose() * now.deviations);
    const Spread next = spread_at(c + step);
    if (next.mean_square < now.mean_square) {
      c += step;
      now = next;
      damping *= 0.3;
      if (step.norm() < 1e-3) break;
    } else {
      damping = damping * 10.0 + 1e-3;
      if (damping > 1e4) break;
    }
  }
  JointCentre result;
  result.definition = "congruency";
  result.centre = c;
  result.rms = std::sqrt(now.mean_square);
  // the samples of one pose are alike near by: count one independent witness per tenth of them
  result.interval =
      1.96 * result.rms * std::sqrt(10.0 * information.inverse().diagonal().maxCoeff());
  result.region = join_text("space from ", n, " points of the socket to the head in ",
                            rotations.size(), " poses");
  return result;
}

JointCentreResult find_joint_centre(const SurfaceSet& surfaces, const JointCentreOptions& options,
                                    const Monitor& monitor) {
  require(0 < options.smallest_radius && options.smallest_radius < options.largest_radius,
          "smallest_radius must be above 0 and below largest_radius, got ", options.smallest_radius,
          " and ", options.largest_radius);
  require(options.neck_cone >= 0 && options.neck_cone < kPi / 2,
          "neck_cone must be in [0, 90) degrees, got ", degrees(options.neck_cone));
  const TriMesh* femur = find_mesh(surfaces, "femur");
  const TriMesh* head_cartilage = find_mesh(surfaces, "femoral_cartilage");
  const TriMesh* socket_cartilage = find_mesh(surfaces, "acetabular_cartilage");
  require(femur || head_cartilage || socket_cartilage,
          "the joint centre needs at least one of the surfaces femur, femoral_cartilage, "
          "acetabular_cartilage");

  JointCentreResult result;
  std::optional<Vec3> start = options.start;
  if (!start && head_cartilage)
    start = find_head(surface_samples(*head_cartilage), options.smallest_radius,
                      options.largest_radius);
  if (!start && femur)
    start = find_head(surface_samples(*femur), options.smallest_radius, options.largest_radius);
  if (!start && socket_cartilage) start = socket_cartilage->points.colwise().mean();
  require(start.has_value(), "no part of the femur looks like a head of ", options.smallest_radius,
          " to ", options.largest_radius, " mm radius; give the landmark femoral_head_centre");
  monitor.progress("joint centre", 0.2);

  if (femur) result.all.push_back(fit_femoral_head(surface_samples(*femur), *start, options));
  if (head_cartilage) {
    result.all.push_back(
        named(fit_facing(surface_samples(*head_cartilage), *start, Facing::outward, options),
              "femoral_cartilage", "articular side of the femoral cartilage"));
  }
  if (socket_cartilage) {
    const SurfaceSamples samples = surface_samples(*socket_cartilage);
    result.all.push_back(named(fit_facing(samples, *start, Facing::inward, options),
                               "acetabular_cartilage",
                               "articular side of the acetabular cartilage"));
    result.all.push_back(named(fit_facing(samples, *start, Facing::outward, options), "acetabulum",
                               "bone side of the acetabular cartilage"));
  }
  monitor.progress("joint centre", 0.5);
  result.chosen = result.all.front();
  const TriMesh* head = head_cartilage ? head_cartilage : femur;
  if (options.congruency_samples > 0 && head && socket_cartilage) {
    result.all.push_back(congruency_centre(
        *head, facing_part(*socket_cartilage, result.chosen.centre, Facing::inward),
        result.chosen.centre, options.congruency_samples));
  }
  for (const JointCentre& a : result.all) {
    for (const JointCentre& b : result.all)
      result.largest_spread = std::max(result.largest_spread, (a.centre - b.centre).norm());
  }
  if (result.largest_spread > 3.0) {
    result.warnings.push_back(join_text("the definitions of the joint centre differ by up to ",
                                        result.largest_spread, " mm"));
  }
  monitor.progress("joint centre", 1.0);
  return result;
}

}  // namespace coxa::motion
