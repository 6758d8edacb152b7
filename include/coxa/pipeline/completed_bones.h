#pragma once

#include <coxa/mesh/surface_set.h>
#include <coxa/motion/bone_frames.h>
#include <coxa/motion/joint_centre.h>
#include <coxa/shape/atlas.h>

namespace coxa::pipeline {

/// A bone as the shape model completes it beyond what is in view.
struct CompletedBone {
  TriMesh surface;                        ///< the whole bone of the model, LPS mm
  std::map<std::string, Vec3> landmarks;  ///< the model's, without side suffix, LPS mm
  Vec3 leftward = Vec3::UnitX();  ///< the body's axis to the left, as the model is posed, unit
  double residual = 0.0;          ///< mm, root mean square where the bone is in view
  double in_view = 0.0;           ///< share of the model's vertices that found the bone, 0..1
};

/// How a joint centre is found: a head seen in part is completed by the mean shape of heads that
/// ships with coxa (data/femoral_head.toml).
motion::JointCentreOptions joint_centre_options(Side side);

/// Most probable shape of `model` given the part of a bone that is in view.
///
/// Nearest points with compatible normals, within a distance that shrinks from 20 to 4 mm; ends of
/// an open surface do not count.
/// @param seen         part of the bone, LPS mm, outward
/// @param head_centre  LPS mm, of the femoral head: where the model is laid first
/// @throws Error bad_input when less than a tenth of the model finds the bone
CompletedBone complete_bone(const TriMesh& seen, const shape::StructureModel& model,
                            const Vec3& head_centre, Side side);

/// Standard deviation of one coordinate of a completed landmark; mm. docs/motion.md section 3.
inline constexpr double kCompletedLandmarkSd = 6.0;

/// ASIS and PSIS of both sides from one hip bone: its own by the shape model, the others mirrored
/// at the median plane, which the model knows as the mean of its examples.
motion::FrameLandmarks completed_pelvis_landmarks(const CompletedBone& hip_bone, Side side);

/// Bone frames with what is missing completed from the atlas: pelvis landmarks where `landmarks`
/// has too few, the femur where the epicondyles are not known.
motion::BoneFrames make_completed_frames(const SurfaceSet& surfaces,
                                         const motion::FrameLandmarks& landmarks,
                                         const shape::Atlas& atlas, const Vec3& joint_centre,
                                         Side side, const motion::BoneFrameOptions& options = {});

}  // namespace coxa::pipeline
