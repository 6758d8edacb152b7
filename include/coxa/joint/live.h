#pragma once

#include <coxa/joint/simulate.h>

#include <memory>
#include <optional>

namespace coxa::joint {

/// Options of a hip led by hand: shorter steps and fewer rounds than a simulation's. Each step
/// looks for pairs once and leaves up to a fiftieth of the joint force to the next one; what that
/// costs is what `LiveHip::settle` finds.
JointOptions live_options();

/// A hip that follows a hand: each call goes one step from the state the last one left.
///
/// Results depend on the way taken, as far as the tolerance of `live_options` lets them.
class LiveHip {
 public:
  /// Seats the head in the image pose.
  /// @param model  kept by reference: must outlive it
  /// @param load   mode `force`: one force for all poses
  /// @throws Error bad_input, bad_mesh for model or load; no_convergence if the head cannot be
  ///         seated
  LiveHip(const JointModel& model, const LoadCase& load);
  ~LiveHip();

  /// Where the femur, outside its cartilage-covered head, is nearest to the hip bone or the labrum.
  struct NearPlace {
    double clearance = 0.0;  ///< mm, negative overlap
    Vec3 point;              ///< mm, image frame, on the hip bone or labrum
    double hour = 0.0;       ///< on the clock face
  };
  struct Step {
    /// At the pose reached; `angles` are those. Strains and sectors are those of `settle` alone.
    FrameResult frame;
    bool arrived = true;                    ///< false: another call goes further
    std::optional<NearPlace> bone, labrum;  ///< nullopt where not near; where the bones would meet,
                                            ///< as they would
  };
  /// Turns the femur at most one `max_rotation_step` of the way to `target` and finds the
  /// equilibrium there.
  ///
  /// Where the bones would meet the femur stays, and the frame says beyond_bony_limit; where no
  /// equilibrium is found, not even half or a quarter of the way, it stays likewise, and the frame
  /// is failed with the reason.
  /// @throws Error cancelled
  Step step_towards(const motion::HipAngles& target, const Monitor& monitor = {});

  /// Equilibrium at the present pose to the full tolerance of JointOptions.
  /// @throws Error cancelled, leaving the state as it was
  Step settle(const Monitor& monitor = {});

  /// Where the femur is.
  motion::HipAngles angles() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coxa::joint
