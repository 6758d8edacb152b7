#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/rigid_transform.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/tri_mesh.h>

#include <functional>
#include <optional>
#include <vector>

namespace coxa::collide {

/// How near two surfaces are, and where.
struct Clearance {
  double distance = kInfinity;       ///< mm, signed: negative where they overlap
  Vec3 fixed_point = Vec3::Zero();   ///< on the fixed surface, in its frame, mm
  Vec3 moving_point = Vec3::Zero();  ///< on the moving surface, in the fixed frame, mm
};

/// First contact of a movement.
struct FirstContact {
  double parameter = 0.0;  ///< of the path, where the distance first falls to the threshold
  Clearance clearance;
};

/// Two rigid closed surfaces, one moving: their clearance at any pose.
///
/// The distance is the least signed one of the vertices of each surface to the other surface. An
/// edge that crosses an edge between vertices is missed by at most (edge length)² / (8 radius of
/// curvature).
/// @note keeps copies of the surfaces; queries are const, bit-identical for any number of threads.
class RigidPair {
 public:
  /// @param counted per moving vertex: whether contact there counts; empty means all
  /// @throws Error bad_mesh if a surface has no triangle; bad_input if `counted` has another length
  RigidPair(const TriMesh& fixed, const TriMesh& moving, std::vector<bool> counted = {});

  /// Clearance with the moving surface at pose X (p_fixed = X p_moving), looked for up to `limit`
  /// mm.
  /// @returns distance infinity where nothing is nearer than `limit`, nor overlaps by less than it
  Clearance clearance(const RigidTransform& X, double limit) const;

 private:
  TriangleTree fixed_, moving_;
  std::vector<bool> counted_;
};

/// Deepest overlap of closed surfaces a and b in one frame, mm, >= 0; 0 when they are apart.
double penetration(const TriMesh& a, const TriMesh& b);

/// First parameter on [0, last] where the surfaces come within `threshold` mm.
///
/// Walks in unit steps, then bisects to 1e-3 of a step. A contact that comes and goes within one
/// step is missed.
/// @param pose_at pose of the moving surface at a parameter
/// @returns nullopt when they never do
std::optional<FirstContact> first_contact(const RigidPair& pair,
                                          const std::function<RigidTransform(double)>& pose_at,
                                          Index last, double threshold = 0.0);

}  // namespace coxa::collide
