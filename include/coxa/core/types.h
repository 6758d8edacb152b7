#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>

namespace coxa {

/// Number of a vertex, triangle, tetrahedron, particle or frame.
using Index = std::int32_t;

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using VecX = Eigen::VectorXd;
using MatX = Eigen::MatrixXd;

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< n×3, mm
using Triangles = Eigen::Matrix<Index, Eigen::Dynamic, 3,
                                Eigen::RowMajor>;  ///< m×3, counter-clockwise from outside
using Tets = Eigen::Matrix<Index, Eigen::Dynamic, 4, Eigen::RowMajor>;  ///< m×4, positive volume

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kPi = 3.14159265358979323846;

/// Degrees to radians, for constants; user-facing conversion happens in `io`.
inline constexpr double radians(double degrees) { return degrees * kPi / 180.0; }
/// Radians to degrees.
inline constexpr double degrees(double radians) { return radians * 180.0 / kPi; }

/// The side of the body a hip belongs to.
enum class Side { left, right };

}  // namespace coxa
