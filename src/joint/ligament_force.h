#pragma once

#include <coxa/dynamics/particles.h>
#include <coxa/joint/ligament.h>

#include <vector>

namespace coxa::joint {

/// The shortest way from an origin to an insertion that does not enter a sphere.
struct LigamentPath {
  double length = 0.0;                 // mm
  Vec3 towards_origin = Vec3::Zero();  // unit, along its last part; dlength/dorigin
  Mat3 curvature = Mat3::Zero();       // of the length by the origin, 1/mm; its positive part
};
/// @param radius  mm, 0: straight; both ends must be outside the sphere
LigamentPath ligament_path(const Vec3& origin, const Vec3& insertion, const Vec3& centre,
                           double radius);

/// Pull of the ligaments on the femur, whose translation is a particle: linear in the stretch, none
/// when slack.
class LigamentForce : public dynamics::Force {
 public:
  /// @param insertions   particle of the first one's insertion; the others follow
  /// @param centre       particle of the joint centre; like the insertions without the translation
  LigamentForce(std::vector<Ligament> ligaments, Index insertions, Index centre, Index translation)
      : ligaments_(std::move(ligaments)),
        insertions_(insertions),
        centre_(centre),
        translation_(translation) {}

  std::vector<std::pair<Index, Index>> pattern() const override {
    return {{translation_, translation_}};
  }
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX& x) const override;

  VecX tensions(const VecX& x) const;   ///< N
  Vec3 pull(const VecX& x) const;       ///< of all on the femur, N
  Mat3 stiffness(const VecX& x) const;  ///< -dpull/dtranslation, its positive part, N/mm

 private:
  std::size_t size() const { return ligaments_.size(); }
  LigamentPath path(std::size_t k, const VecX& x) const;
  double stretch(std::size_t k, double length) const;  // mm, 0 when slack

  std::vector<Ligament> ligaments_;
  Index insertions_, centre_, translation_;
};

}  // namespace coxa::joint
