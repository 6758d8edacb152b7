#pragma once

#include <coxa/collide/surface_contact.h>

#include <vector>

namespace coxa::collide {

/// The surface that samples look for, at its current position.
struct OtherSurface {
  const TriangleTree& tree;
  const Points& vertex_normals;  ///< V×3, unit
  const Eigen::Matrix<bool, Eigen::Dynamic, 3, Eigen::RowMajor>& boundary_edge;
  const std::vector<bool>& boundary_vertex;
};

/// Point of the other surface that a sample faces.
struct FacedPoint {
  Index triangle = 0;
  Vec3 barycentric = Vec3::Zero();  ///< may leave [0, 1] slightly with smooth normals
  Vec3 normal = Vec3::Zero();       ///< unit, away from the other surface
};

/// What a sample at `point` with outward normal `normal` faces; nullopt when nothing near enough
/// does.
std::optional<FacedPoint> find_faced_point(const OtherSurface& other, const Vec3& point,
                                           const Vec3& normal, const ContactOptions& options);

}  // namespace coxa::collide
