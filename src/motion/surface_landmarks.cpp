#include <coxa/core/error.h>
#include <coxa/motion/bone_frames.h>

#include <Eigen/Geometry>
#include <cmath>

namespace coxa::motion {
namespace {

// a femur with its knee: from the head's centre to the condyles, and across the epicondyles, mm
constexpr double kShortestFemur = 300.0, kNarrowestKnee = 60.0;
constexpr double kKneeHeight = 60.0;  // mm, of the part that holds the condyles

Points rows_above(const Points& points, const VecX& heights, double limit) {
  std::vector<Index> rows;
  for (Index v = 0; v < points.rows(); ++v) {
    if (heights[v] > limit) rows.push_back(v);
  }
  return points(rows, Eigen::all);
}

// mean of the vertices within `depth` of the farthest one along `direction`
Vec3 farthest(const Points& points, const Vec3& direction, double depth) {
  const VecX along = points * direction;
  return rows_above(points, along, along.maxCoeff() - depth).colwise().mean();
}

}  // namespace

std::optional<Epicondyles> find_epicondyles(const TriMesh& femur, const Vec3& joint_centre,
                                            Side side) {
  constexpr double kMiddle = 3.0;   // mm: where an epicondyle is flat, the middle of what is there
  constexpr double kCondyle = 0.3;  // mm
  constexpr double kNotch = 8.0;    // mm, half-width of what lies between the condyles
  constexpr int kRounds = 20;
  const VecX far = (femur.points.rowwise() - joint_centre.transpose()).rowwise().norm();
  Eigen::Index end = 0;
  if (far.maxCoeff(&end) < kShortestFemur) return std::nullopt;
  const Vec3 down = (femur.points.row(end).transpose() - joint_centre).normalized();
  const VecX depth = femur.points * down;
  const Points knee = rows_above(femur.points, depth, depth.maxCoeff() - kKneeHeight);
  const Vec3 middle = knee.colwise().mean();
  const Vec3 y = (joint_centre - middle).normalized();
  // across the line of the posterior condyles, from the image's axis on
  Vec3 lateral = side == Side::right ? Vec3(supine_axes().col(2)) : Vec3(-supine_axes().col(2));
  for (int round = 0; round < kRounds; ++round) {
    lateral = (lateral - lateral.dot(y) * y).normalized();
    const Vec3 posterior = side == Side::right ? lateral.cross(y) : y.cross(lateral);
    const VecX across = (knee.rowwise() - middle.transpose()) * lateral;
    const Points outer = rows_above(knee, across, kNotch),
                 inner = rows_above(knee, -across, kNotch);
    if (outer.rows() == 0 || inner.rows() == 0) return std::nullopt;
    lateral = farthest(outer, posterior, kCondyle) - farthest(inner, posterior, kCondyle);
  }
  lateral = (lateral - lateral.dot(y) * y).normalized();
  const Epicondyles found{farthest(knee, -lateral, kMiddle), farthest(knee, lateral, kMiddle)};
  if ((found.lateral - found.medial).norm() < kNarrowestKnee) return std::nullopt;
  return found;
}

}  // namespace coxa::motion
