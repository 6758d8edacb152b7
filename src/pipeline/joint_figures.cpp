#include "joint_figures.h"

#include <coxa/core/error.h>

#include <algorithm>
#include <cmath>

namespace coxa::pipeline {
namespace {

// share of the joint force on bare bone that no healthy hip has
constexpr double kMuchOnBone = 0.1;
// share of it on edges of cartilage beyond which they make the peaks
constexpr double kMuchOnThin = 0.1;

void add_limit(const std::string& name, const joint::BonyLimit& limit, Record& record) {
  record.figures[name + "_flexion_deg"] = degrees(limit.angles.flexion);
  record.figures[name + "_adduction_deg"] = degrees(limit.angles.adduction);
  record.figures[name + "_internal_rotation_deg"] = degrees(limit.angles.internal_rotation);
  record.figures[name + "_clock_hour"] = limit.hour;
  record.figures[name + "_place_lps_mm"] =
      join_text(limit.place.x(), " ", limit.place.y(), " ", limit.place.z());
}

void add_sensitivity(const joint::CentreSensitivity& sensitivity, Record& record) {
  double lowest = kInfinity, highest = -kInfinity;
  for (const double peak : sensitivity.peak.reshaped()) {
    if (peak == peak) lowest = std::min(lowest, peak), highest = std::max(highest, peak);
  }
  record.figures["sensitivity_shift_mm"] = sensitivity.shift;
  record.figures["sensitivity_peak_at_rest_mpa"] = sensitivity.at_rest;
  if (lowest > highest) return;
  record.figures["sensitivity_lowest_peak_mpa"] = lowest;
  record.figures["sensitivity_highest_peak_mpa"] = highest;
}

/// One warning for all frames in which an edge is crushed, with the worst of them.
void warn_of_crushed_edges(const joint::JointResult& result, Record& record) {
  const joint::FrameResult* worst = nullptr;
  int crushed = 0;
  for (const joint::FrameResult& frame : result.frames) {
    if (frame.status != joint::FrameStatus::converged) continue;
    const double ratio = frame.crush.least_volume_ratio;
    if (ratio >= joint::kSolidShare) continue;
    ++crushed;
    if (!worst || ratio < worst->crush.least_volume_ratio) worst = &frame;
  }
  if (!worst) return;
  record.warnings.push_back(
      join_text("an edge bears so much in ", crushed, " of ", result.n_converged(),
                " frames that it is crushed, and peak pressures tell of that edge; most in frame ",
                worst->frame, ", where the ", worst->crush.body, " near ",
                worst->crush.place.transpose(), " is squeezed to ",
                std::lround(100.0 * worst->crush.least_volume_ratio), " % of its volume"));
}

/// One warning for all frames in which edges thinner than any image measures bear much.
void warn_of_thin_edges(const joint::JointResult& result, Record& record) {
  double share = 0.0, with = 0.0, without = 0.0;
  for (const joint::FrameResult& frame : result.frames) {
    const double all = frame.balance.contact_force.norm();
    if (frame.status != joint::FrameStatus::converged || !(all > 0.0)) continue;
    share = std::max(share, frame.thin.force / all);
    with = std::max(with, frame.contact.peak_pressure_p99);
    without = std::max(without, frame.thin.peak_pressure_p99);
  }
  record.figures["largest_share_on_thin_cartilage_percent"] = 100.0 * share;
  record.figures["largest_peak_pressure_p99_thick_mpa"] = without;
  if (share <= kMuchOnThin) return;
  record.warnings.push_back(join_text(
      "up to ", std::lround(100.0 * share),
      " % of the joint force rests on acetabular cartilage thinner than ", joint::kThinCartilage,
      " mm, which is an edge's shape rather than a measured thickness; the highest peak pressure "
      "is ",
      with, " MPa with it and ", without, " MPa without"));
}

}  // namespace

void add_joint_figures(const joint::JointResult& result, Record& record) {
  record.figures["frames"] = static_cast<std::int64_t>(result.frames.size());
  record.figures["frames_converged"] = std::int64_t{result.n_converged()};
  record.figures["load"] = result.load_description;
  double peak = 0.0, force_error = 0.0, reaction_error = 0.0, bare = 0.0, bare_femur = 0.0;
  double labrum_share = 0.0, labrum_peak = 0.0, labrum_strain = 0.0;
  VecX tension = VecX::Zero(static_cast<Eigen::Index>(result.ligaments.size()));
  for (const joint::FrameResult& frame : result.frames) {
    if (frame.status == joint::FrameStatus::failed) {
      record.warnings.push_back(
          join_text("frame ", frame.frame, " did not converge: ", frame.reason));
    }
    if (frame.status != joint::FrameStatus::converged) continue;
    peak = std::max(peak, frame.contact.peak_pressure_p99);
    if (const double all = frame.balance.contact_force.norm(); all > 0.0) {
      bare = std::max(bare, frame.balance.force_on_bone.norm() / all);
      bare_femur = std::max(bare_femur, frame.balance.force_of_femur.norm() / all);
    }
    labrum_share = std::max(labrum_share, frame.labrum.force_share);
    labrum_peak = std::max(labrum_peak, frame.labrum.peak_pressure_p99);
    labrum_strain = std::max(labrum_strain, frame.labrum.peak_strain_p99);
    tension = tension.cwiseMax(frame.ligament_tension);
    force_error = std::max(force_error, frame.balance.force_error);
    reaction_error = std::max(reaction_error, frame.balance.reaction_error);
  }
  warn_of_crushed_edges(result, record);
  warn_of_thin_edges(result, record);
  record.figures["largest_peak_pressure_p99_mpa"] = peak;
  record.figures["largest_share_on_bare_bone_percent"] = 100.0 * bare;
  if (result.bare_bone == joint::BareBone::both)
    record.figures["largest_share_of_bare_femur_percent"] = 100.0 * bare_femur;
  if (result.has_labrum_body) {
    record.figures["largest_share_on_labrum_percent"] = 100.0 * labrum_share;
    record.figures["largest_labrum_pressure_p99_mpa"] = labrum_peak;
    record.figures["largest_labrum_strain_p99"] = labrum_strain;
  }
  for (std::size_t k = 0; k < result.ligaments.size(); ++k)
    record.figures["largest_tension_" + result.ligaments[k] + "_N"] =
        tension[static_cast<Eigen::Index>(k)];
  if (bare > kMuchOnBone) {
    record.warnings.push_back(join_text(
        "up to ", 100.0 * bare,
        " % of the joint force rests on bone that no acetabular cartilage covers: its rim may have "
        "been found too short, or the bone beside it too near; pressures on the cartilage are then "
        "too low"));
  }
  record.figures["largest_force_error_percent"] = 100.0 * force_error;
  record.figures["largest_reaction_error"] = reaction_error;
  if (result.bony_limit) add_limit("bony_limit", *result.bony_limit, record);
  if (result.labrum_contact) add_limit("labrum_contact", *result.labrum_contact, record);
  if (result.sensitivity) add_sensitivity(*result.sensitivity, record);
}

}  // namespace coxa::pipeline
