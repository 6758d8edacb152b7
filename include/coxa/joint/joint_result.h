#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/clock_face.h>
#include <coxa/geom/rigid_transform.h>
#include <coxa/joint/joint_model.h>
#include <coxa/motion/hip_motion.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace coxa::joint {

/// What a frame is worth.
enum class FrameStatus {
  converged,          ///< a result
  failed,             ///< no equilibrium found; `reason` says why; holds no stress
  beyond_bony_limit,  ///< the bones would overlap; holds no stress
};

/// "converged", "failed" or "beyond_bony_limit".
const char* name_of(FrameStatus status);

/// The six regions of the socket, 60 degrees each on the clock face.
inline constexpr std::array<const char*, 6> kRegionNames = {"superior",        "anterosuperior",
                                                            "anteroinferior",  "inferior",
                                                            "posteroinferior", "posterosuperior"};

/// Figures of a part of the acetabular cartilage.
struct SectorFigures {
  double volume = 0.0;   ///< mm³; 0: no cartilage there, the strains are NaN
  double strain = kNaN;  ///< volume mean of the effective strain sqrt(2/3 dev E : dev E), Green
  double compression =
      kNaN;  ///< volume mean of the least principal Green strain (negative: compressed)
  double mean_pressure = 0.0;  ///< MPa, over the sector's articular area, contact or not
};

/// Contact figures of one converged frame; pressures are of the acetabular articular surface.
struct ContactFigures {
  double peak_pressure_p99 = 0.0;    ///< MPa, 99th percentile by area of the pressure in contact
  double peak_pressure_p95 = 0.0;    ///< MPa, 95th
  double peak_pressure_patch = 0.0;  ///< MPa, greatest mean over a patch of 5 mm²
  double mean_pressure = 0.0;        ///< MPa, over the contact area
  double contact_area = 0.0;         ///< mm², where the surfaces press on each other
  double contact_share = 0.0;        ///< of the acetabular articular area, in [0, 1]
  Vec3 centre_of_pressure = Vec3::Constant(kNaN);  ///< mm, image frame
  double centre_hour = kNaN;                       ///< of the centre of pressure on the clock face
  double penetration =
      0.0;  ///< mm, largest overlap left: mean around a node, as contact is enforced
  double deepest_sample = 0.0;  ///< mm, largest overlap at a single sampling point
};

/// Thinner than this at rest, about a voxel of the finest MRI of hips, cartilage is an edge that no
/// image has measured, and its pressures are those of its shape, mm.
inline constexpr double kThinCartilage = 0.5;

/// What the acetabular cartilage's thin edges make of one converged frame's contact.
struct ThinFigures {
  double force = 0.0;              ///< N, pressure summed over what is thinner than kThinCartilage
  double peak_pressure_p99 = 0.0;  ///< MPa, 99th percentile by area of the rest
};

/// How near one converged frame comes to crushing an element.
struct CrushFigures {
  double least_volume_ratio = 1.0;    ///< deformed over reference volume of the worst element
  Vec3 place = Vec3::Constant(kNaN);  ///< mm, image frame, its middle before deformation
  std::string body;  ///< it belongs to: "acetabular cartilage", "femoral cartilage", "labrum"
};

/// The soft labrum in one converged frame; all 0 where there is none.
struct LabrumFigures {
  double force_share = 0.0;        ///< of the contact force, in [0, 1]
  double peak_pressure_p99 = 0.0;  ///< MPa, 99th percentile by area of the nodes that press
  double contact_area = 0.0;       ///< mm², of those nodes
  double strain = 0.0;             ///< volume mean of the effective strain
  double peak_strain_p99 = 0.0;    ///< its 99th percentile by volume
};

/// Balance of one converged frame.
struct BalanceFigures {
  Vec3 applied_force =
      Vec3::Zero();  ///< N, femur onto socket, image axes; NaN with a prescribed pose
  Vec3 contact_force = Vec3::Zero();   ///< N, femur onto socket: integral of pressure times normal,
                                       ///< bare bone included, and friction
  Vec3 friction_force = Vec3::Zero();  ///< N, the part of it by friction
  Vec3 friction_moment = Vec3::Zero();  ///< N·mm, of friction on the socket about the joint centre
  Vec3 force_on_bone = Vec3::Zero();    ///< N, the part of it on hip bone that no cartilage covers
  Vec3 force_of_femur = Vec3::Zero();   ///< N, the part of it by femur that no cartilage covers
  Vec3 force_on_labrum = Vec3::Zero();  ///< N, the part of it on the soft labrum
  Vec3 ligament_force = Vec3::Zero();   ///< N, of the ligaments on the femur
  Vec3 socket_reaction = Vec3::Zero();  ///< N, of the acetabular bone side onto the hip bone
  Vec3 femur_reaction = Vec3::Zero();   ///< N, of the femoral bone side onto the femur
  Vec3 labrum_reaction = Vec3::Zero();  ///< N, of the labrum's seat onto the hip bone
  double force_error =
      0.0;  ///< |contact - applied - ligaments| / |applied|; 0 with a prescribed pose
  double reaction_error = 0.0;  ///< |socket + bare bones + labrum + femur| / |contact force|
  double elastic_energy = 0.0;  ///< N·mm, of cartilages and ligaments
  double contact_energy = 0.0;  ///< N·mm, left in the penalty
  double work = 0.0;  ///< N·mm, done by the femur's bone side since the first loaded state
};

/// One frame of the movement.
struct FrameResult {
  Index frame = 0;
  FrameStatus status = FrameStatus::failed;
  std::string reason;  ///< empty when converged
  motion::HipAngles angles;
  RigidTransform
      X_II;  ///< femur from its image pose to this frame, image frame, translation included
  Vec3 translation =
      Vec3::Zero();  ///< mm, image axes: found beside the rotation about the joint centre
  double bone_clearance =
      kNaN;  ///< mm, least distance of the bones, negative overlap; NaN where not near
  double labrum_clearance = kNaN;  ///< likewise of femur and labrum

  // of converged frames only, else empty
  Points acetabular_displacement;  ///< N×3, mm
  Points femoral_displacement;     ///< N×3, mm, against the femoral nodes moved by X_II
  VecX acetabular_pressure;        ///< MPa per node, 0 off the articular side
  VecX acetabular_gap;    ///< mm per node; NaN off the articular side and where nothing faces it
  VecX femoral_pressure;  ///< MPa per node, 0 off the articular side
  Points labrum_displacement;  ///< mm, of the soft labrum's nodes; empty where there is none
  VecX labrum_pressure;        ///< MPa per node
  ContactFigures contact;
  BalanceFigures balance;
  ThinFigures thin;
  CrushFigures crush;
  LabrumFigures labrum;
  VecX ligament_tension;                  ///< N, as the model's ligaments
  std::array<SectorFigures, 12> sectors;  ///< sector h is centred on h o'clock, 0 on twelve
  std::array<SectorFigures, 6> regions;   ///< as kRegionNames
  double residual = 0.0;  ///< of the free nodes' forces, relative to the joint force
  int iterations = 0;     ///< Newton steps, all sub-steps together
  double seconds = 0.0;
};

/// First meeting of the femur, outside its cartilage-covered head, with the hip bone or the labrum.
struct BonyLimit {
  Index frame = 0;           ///< first frame beyond
  motion::HipAngles angles;  ///< where the bones first touch, between that frame and the one before
  Vec3 place = Vec3::Zero();  ///< mm, image frame, on the hip bone or labrum
  double hour = 0.0;          ///< on the clock face
};

/// Peak pressure (99th percentile) when the head sits elsewhere: the pose held, shifted along
/// pelvis axes.
struct CentreSensitivity {
  Index frame = 0;
  double shift = 0.0;    ///< mm
  double at_rest = 0.0;  ///< MPa, not shifted
  Eigen::Matrix<double, 3, 2>
      peak;  ///< MPa, row: anterior, superior, right axis; column: -, +; NaN: failed
};

struct JointResult {
  std::vector<FrameResult> frames;
  ClockFace clock;
  double articular_area = 0.0;  ///< mm², acetabular, undeformed
  std::optional<BonyLimit> bony_limit;
  /// Where the femur first touches the labrum; frames beyond are solved all the same, as if it were
  /// not there.
  std::optional<BonyLimit> labrum_contact;
  bool has_labrum = false;       ///< the model, as a rigid surface
  bool has_labrum_body = false;  ///< the model, as soft tissue
  std::optional<CentreSensitivity> sensitivity;
  std::string load_description;
  BareBone bare_bone = BareBone::hip_bone;  ///< of the model
  bool has_friction = false;                ///< the model
  std::vector<std::string> ligaments;       ///< the model's, by name
  double seconds = 0.0;

  Index n_converged() const;
};

/// Element fields of one converged frame.
struct StressFields {
  MatX green_strain;      ///< M×6, xx yy zz xy yz zx (tensor components), image axes
  MatX cauchy_stress;     ///< M×6 MPa
  MatX principal_stress;  ///< M×3 MPa, descending, tension positive
  MatX principal_strain;  ///< M×3, descending (Green)
  VecX von_mises;         ///< M, MPa
};

}  // namespace coxa::joint
