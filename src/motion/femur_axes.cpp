#include <coxa/motion/bone_frames.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/mesh/measures.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace coxa::motion {
namespace {

// distances from the joint centre along the shaft, in head radii, that the shaft's line is fitted
// over: from below the lesser trochanter to where the femur ends or flares
constexpr double kShaftBegin = 3.4, kShaftEnd = 7.5;
constexpr double kSectionStep = 3.0;  // mm

struct Section {
  Vec3 centroid = Vec3::Zero();
  double length = 0.0;  // mm, of the outline
};

// outline of the surface in the plane (point, unit normal): centroid weighted by length
std::optional<Section> section_of(const TriMesh& mesh, const Vec3& point, const Vec3& normal,
                                  double reach) {
  Section section;
  const VecX height = (mesh.points.rowwise() - point.transpose()) * normal;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    std::vector<Vec3> crossings;
    for (int k = 0; k < 3; ++k) {
      const Index a = mesh.triangles(t, k), b = mesh.triangles(t, (k + 1) % 3);
      if ((height[a] < 0) == (height[b] < 0)) continue;
      const double share = height[a] / (height[a] - height[b]);
      crossings.push_back((1.0 - share) * mesh.points.row(a).transpose() +
                          share * mesh.points.row(b).transpose());
    }
    if (crossings.size() != 2) continue;
    const Vec3 middle = 0.5 * (crossings[0] + crossings[1]);
    if ((middle - point).norm() > reach) continue;
    const double length = (crossings[0] - crossings[1]).norm();
    section.centroid += length * middle;
    section.length += length;
  }
  if (section.length <= 0) return std::nullopt;
  section.centroid /= section.length;
  return section;
}

// the long direction of the part below the head, pointing proximal
Vec3 rough_shaft_direction(const TriMesh& femur, const Vec3& centre, double radius) {
  const VecX areas = triangle_areas(femur);
  Vec3 sum = Vec3::Zero();
  for (Index t = 0; t < femur.n_triangles(); ++t) {
    const Vec3 p = femur.points(femur.triangles.row(t), Eigen::all).colwise().mean();
    if ((p - centre).norm() > 2.5 * radius) sum += areas[t] * (centre - p);
  }
  require(sum.squaredNorm() > 0, "the femur ends near its head: no shaft is in view");
  return sum.normalized();
}

}  // namespace

ProximalFemurAxes proximal_femur_axes(const TriMesh& femur, const Vec3& centre, double radius) {
  require(radius > 0, "the head's radius must be above 0 mm, got ", radius);
  ProximalFemurAxes axes;
  axes.shaft_direction = rough_shaft_direction(femur, centre, radius);
  axes.shaft_point = centre;
  const double lowest =
      -((femur.points.rowwise() - centre.transpose()) * axes.shaft_direction).minCoeff();

  // sections across the last direction, a line through their centroids, and again
  for (int round = 0; round < 4; ++round) {
    std::vector<Vec3> centroids;
    for (double depth = kShaftBegin * radius; depth < std::min(kShaftEnd * radius, lowest - 4.0);
         depth += kSectionStep) {
      // the section of the shaft alone: near the line so far (anywhere in the first round)
      const double along = (axes.shaft_point - centre).dot(axes.shaft_direction);
      const Vec3 on_line = axes.shaft_point - (along + depth) * axes.shaft_direction;
      if (const auto section = section_of(femur, on_line, axes.shaft_direction,
                                          round == 0 ? 4.0 * radius : 1.5 * radius)) {
        centroids.push_back(section->centroid);
      }
    }
    axes.shaft_length = kSectionStep * (static_cast<double>(centroids.size()) - 1.0);
    require(axes.shaft_length >= 20.0, "only ", std::max(0.0, axes.shaft_length),
            " mm of the femoral shaft are in view; 20 mm are needed to see its direction");
    Points points(static_cast<Eigen::Index>(centroids.size()), 3);
    for (std::size_t k = 0; k < centroids.size(); ++k)
      points.row(static_cast<Eigen::Index>(k)) = centroids[k];
    const Line line = fit_line(points);
    axes.shaft_point = line.point;
    axes.shaft_direction =
        line.direction.dot(axes.shaft_direction) > 0 ? line.direction : Vec3(-line.direction);
  }

  // neck: from the head's centre to the centroids of its sections, those hardly longer than the
  // narrowest, on the way to the shaft; one section alone is easily tilted by what it meets
  constexpr double kNarrow = 1.15;
  const Vec3 d = axes.shaft_point - centre;
  const Vec3 to_shaft = (d - d.dot(axes.shaft_direction) * axes.shaft_direction).normalized();
  Vec3 neck = (to_shaft - 0.8 * axes.shaft_direction).normalized();
  for (int round = 0; round < 8; ++round) {
    std::vector<Section> sections;
    double narrowest = kInfinity;
    for (double depth = 0.8 * radius; depth < 1.8 * radius; depth += 1.0) {
      const auto section = section_of(femur, centre + depth * neck, neck, 1.3 * radius);
      if (!section) continue;
      sections.push_back(*section);
      narrowest = std::min(narrowest, section->length);
    }
    require(!sections.empty(), "no femoral neck is found beside the head");
    Vec3 sum = Vec3::Zero();
    for (const Section& section : sections) {
      if (section.length <= kNarrow * narrowest) sum += (section.centroid - centre).normalized();
    }
    neck = sum.normalized();
  }
  axes.neck_direction = neck;
  return axes;
}

}  // namespace coxa::motion
