#pragma once

#include <coxa/joint/joint_result.h>

#include <utility>
#include <vector>

#include "equilibrium.h"

namespace coxa::joint {

/// The elements of the socket's cartilage on the clock face, and how thick it is, at rest.
struct SocketElements {
  ClockFace clock;
  VecX hour;       ///< of their middles
  VecX volume;     ///< mm³
  VecX thickness;  ///< distance of its nodes from its bone side, mm
};
SocketElements socket_elements(const JointModel& model);

/// Fills what changes from moment to moment while a hand leads: nodal fields, contact but for the
/// peak over a patch, balance.
/// @returns the samples of the cartilages' contact
std::vector<collide::ContactSample> update_contact_figures(
    FrameResult& frame, const JointModel& model, const HipSystem& system, Equilibrium& equilibrium,
    const HipState& state, const ClockFace& clock);

/// Fills all that a converged frame reports: those, the peak over a patch, what thin edges
/// bear, crushed elements, sectors.
void update_figures(FrameResult& frame, const JointModel& model, const HipSystem& system,
                    Equilibrium& equilibrium, const HipState& state,
                    const SocketElements& elements);

/// The samples in contact. Where it ends between two nodes is told by what the rigid bodies would
/// overlap there: inside the pressure over the foundation's stiffness, outside minus the gap, and
/// linear between nodes.
/// @param samples  all of the cartilages' contact at the state
std::vector<collide::ContactSample> samples_in_contact(const HipSystem& system,
                                                       const HipState& state,
                                                       std::vector<collide::ContactSample> samples);

/// What thin cartilage bears of the samples in contact.
/// @param thickness  of the socket's nodes, mm
ThinFigures thin_figures(const std::vector<collide::ContactSample>& touching,
                         const collide::SurfaceContact& contact, const VecX& thickness);

/// The value below which `share` of the weight lies; 0 without values.
/// @param values  each with its weight
double weighted_percentile(std::vector<std::pair<double, double>> values, double share);

/// Pressure below which `share` of the samples' area lies, MPa; 0 without samples.
double pressure_percentile(const std::vector<collide::ContactSample>& samples, double share);

/// Greatest mean pressure over a disc of `area` mm² around a sample that has at least half the
/// largest pressure, MPa.
double patch_peak(const std::vector<collide::ContactSample>& samples, double area);

/// Forces on the held bone-side nodes, elastic and of contact right on them, summed: socket and
/// femur, N.
struct Reactions {
  Vec3 socket = Vec3::Zero(), femur = Vec3::Zero(), labrum = Vec3::Zero();
};
Reactions bone_reactions(const HipSystem& system, const VecX& node_forces);

}  // namespace coxa::joint
