#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/rigid_transform.h>

#include <string>
#include <vector>

namespace coxa::motion {

/// ISB hip angles (Wu 2002; Grood-Suntay sequence z-x-y), rad; same signs for left and right:
/// flexion +, adduction +, internal rotation +.
struct HipAngles {
  double flexion = 0.0, adduction = 0.0, internal_rotation = 0.0;
};

/// Anatomical frame of a bone in image space, and where it came from.
struct BoneFrame {
  RigidTransform X_IB;  ///< pose of the bone's ISB frame (x anterior, y superior, z right) in the
                        ///< image frame I
  std::string source;   ///< for example "landmarks", "shape model completion", "image axes", "shaft
                        ///< and neck"
  double interval = 0.0;  ///< half-width of the 95 % interval of its axes, rad; 0 where not known
};

/// Movement of the femur relative to the pelvis, frame by frame.
struct HipMotion {
  std::vector<double> time;       ///< s
  std::vector<HipAngles> angles;  ///< per frame
  std::vector<HipAngles>
      interval;  ///< half-width of 95 % intervals per frame; empty where not known
  /// Femur in pelvis: p_P = X_PF p_F with ISB frames whose origins are the hip joint centre.
  std::vector<RigidTransform> X_PF;
  Points head_lab;  ///< frames×3, femoral head centre in the laboratory, mm; empty without markers
  std::string method;
  std::vector<std::string> warnings;

  Index n_frames() const { return static_cast<Index>(time.size()); }
};

/// Rotation of femur in pelvis axes, R = Rz(flexion) Rx(adduction) Ry(internal rotation); left hips
/// negate the last two.
Mat3 rotation_from_angles(const HipAngles& angles, Side side);
/// The inverse; adduction in [-pi/2, pi/2].
HipAngles angles_from_rotation(const Mat3& R_PF, Side side);

}  // namespace coxa::motion
