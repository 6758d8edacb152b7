#pragma once

#include <coxa/motion/marker_data.h>

#include <string>
#include <vector>

namespace coxa::motion {

/// Labels that a laboratory may use, in order of preference; # stands for digits.
struct FootLabels {
  std::vector<std::string> heel_left = {"LHEE", "LHEEL", "LHEL", "L.Heel", "LCAL", "L_heel"};
  std::vector<std::string> heel_right = {"RHEE", "RHEEL", "RHEL", "R.Heel", "RCAL", "R_heel"};
  std::vector<std::string> toe_left = {"LTOE", "LMT2", "LMTP2", "L.Toe.Tip", "L_toe", "LMT5"};
  std::vector<std::string> toe_right = {"RTOE", "RMT2", "RMTP2", "R.Toe.Tip", "R_toe", "RMT5"};
};

struct FoundEvents {
  std::vector<MarkerEvent> events;  ///< "Foot Strike", "Foot Off" of "Left" and "Right", by time
  std::string reason;  ///< why there are none: a marker is missing, or it is no walking; else empty
};

/// Foot strikes and toe offs of walking, overground or on a treadmill, from heel, toe and pelvis.
///
/// A foot strikes when its heel is farthest in front of the sacrum, and leaves the floor when its
/// toe is farthest behind it. The pelvis is the sacrum's marker, else the mean of the PSIS; the
/// direction of walking is that of the largest movement of the heels relative to it, forwards as
/// the feet point. Trajectories are low-passed at 7 Hz. Source: Zeni, Richards and Higginson 2008,
/// Gait & Posture 27:710-714.
FoundEvents find_gait_events(const MarkerData& markers, const FootLabels& labels = {});

}  // namespace coxa::motion
