#include <coxa/measure/hip_angles.h>

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace coxa::measure {
namespace {

/// z points right: lateral is +z on a right hip, -z on a left one.
double lateral(const Vec3& v_P, Side side) { return side == Side::right ? v_P.z() : -v_P.z(); }

}  // namespace

AcetabularOrientation acetabular_orientation(const Vec3& axis_P, Side side) {
  const Vec3 axis = axis_P.normalized();
  return {.inclination = std::acos(-axis.y()),
          .version = std::atan2(axis.x(), lateral(axis, side))};
}

double lateral_centre_edge_angle(const Vec3& centre_P, const Vec3& edge_P, Side side) {
  const Vec3 line = edge_P - centre_P;
  return std::atan2(lateral(line, side), line.y());
}

Vec3 find_lateral_edge(const TriMesh& socket_P, const Vec3& centre_P, Side side, double half_slab) {
  require(half_slab > 0.0, "half_slab must be positive, got ", half_slab, " mm");
  std::optional<Vec3> edge;
  for (Index v = 0; v < socket_P.n_vertices(); ++v) {
    const Vec3 p = socket_P.points.row(v), arm = p - centre_P;
    if (std::abs(arm.x()) > half_slab || arm.y() <= 0.0) continue;
    if (!edge || lateral(p, side) > lateral(*edge, side)) edge = p;
  }
  require(edge.has_value(), "the socket has no vertex above the head's centre within ", half_slab,
          " mm of its coronal plane");
  return *edge;
}

double neck_shaft_angle(const Vec3& head_centre, const Vec3& neck_centre,
                        const Vec3& shaft_distal) {
  const Vec3 neck = head_centre - neck_centre;
  return std::atan2(neck.cross(shaft_distal).norm(), neck.dot(shaft_distal));
}

double alpha_angle(const TriMesh& femur, const Sphere& head, const Vec3& neck, const Vec3& towards,
                   const AlphaAngleOptions& options) {
  require(options.tolerance > 0.0, "tolerance must be positive, got ", options.tolerance, " mm");
  require(options.step > 0.0, "step must be positive, got ", options.step, " rad");
  require(0.0 < options.largest && options.largest <= kPi, "largest must be in (0, pi], got ",
          options.largest, " rad");
  const Vec3 axis = neck.normalized(), across = towards - towards.dot(axis) * axis;
  require(across.norm() > 1e-9 * towards.norm(), "the half-plane's side lies along the neck axis");
  const Vec3 side = across.normalized();
  const TriangleTree tree(femur.points, femur.triangles);
  const double limit = 10.0 * head.radius;
  for (double angle = options.largest; angle > 0.0; angle -= options.step) {
    const Vec3 ray = std::cos(angle) * axis + std::sin(angle) * side;
    const auto hit = tree.first_hit(head.centre, ray, limit);
    if (hit && hit->distance > head.radius + options.tolerance) return angle;
  }
  return kNaN;
}

}  // namespace coxa::measure
