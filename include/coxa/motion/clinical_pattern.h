#pragma once

#include <coxa/motion/hip_motion.h>

#include <string>
#include <vector>

namespace coxa::motion {

/// How angles run between the poses of a pattern.
enum class Interpolation {
  smooth,   ///< rest in every pose: smooth step (3 s² - 2 s³) between them
  linear,   ///< straight
  periodic  ///< smooth curve through the poses that closes on itself (the last pose equals the
            ///< first)
};

struct PatternPose {
  double time = 0.0;  ///< s from the beginning, increasing
  HipAngles angles;
};

/// A movement of the hip without markers: poses in time.
struct ClinicalPattern {
  std::string name = {};  ///< for example "fadir"
  std::string description = {};
  std::string source = {};  ///< where the angles come from
  Interpolation interpolation = Interpolation::smooth;
  std::vector<PatternPose> poses = {};  ///< at least two, first at time 0
};

struct MovementOptions {
  double rate = 10.0;  ///< frames per second, > 0; the last pose is always a frame
  Index n_frames = 0;  ///< exactly so many frames, evenly spaced; 0: by rate
  Index cycles = 1;    ///< >= 1, repetitions of a periodic pattern
};

/// The pattern as frames, head at the joint centre.
/// @throws Error bad_input when the pattern's times do not increase or it has fewer than two poses
HipMotion make_movement(const ClinicalPattern& pattern, Side side,
                        const MovementOptions& options = {});

/// Angles at time t, held constant before the first and after the last pose.
HipAngles angles_at(const ClinicalPattern& pattern, double time);

/// `first`, then `second` begun `blend` seconds before `first` ends, the angles mixed by a smooth
/// step in between.
/// @param blend  s, >= 0; 0: one after the other, which must then join within a degree
ClinicalPattern blended(const ClinicalPattern& first, const ClinicalPattern& second, double blend);

/// From one pose to another in `duration` seconds, for example neutral to 90 degrees flexion.
ClinicalPattern simple_pattern(const std::string& name, const HipAngles& from, const HipAngles& to,
                               double duration);

}  // namespace coxa::motion
