#include "usable_surface.h"

#include <coxa/core/error.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/rebuild.h>
#include <coxa/mesh/repair.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/unfold.h>
#include <coxa/mesh/validate.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace coxa::pipeline {
namespace {

// grid and edge length of a surface made anew, mm: a fraction of cartilage's thickness
constexpr double kRebuildSpacing = 0.3, kRebuildEdge = 0.7;

// where more than this of a surface would be left out or moved, mm, it is made anew, and its thin
// parts become walls of twice the thickening on a finer grid, which must see them
constexpr double kLargestLoss = 0.3, kThickening = 0.15, kThinSpacing = 0.2, kThinEdge = 0.5;

// a surface that must move farther than this, mm, about as thick as cartilage, is not evened out
// but another surface
constexpr double kLargestEvening = 2.0;

// a piece with more than this share of the largest one's area is a body of its own
constexpr double kSecondBody = 0.1;

/// Whether a surface is several bodies: made anew they would be one, which nobody asked for.
bool has_second_body(const TriMesh& surface) {
  const VecX areas = piece_areas(surface, triangle_components(surface));
  return (areas.array() > kSecondBody * areas.maxCoeff()).count() > 1;
}

/// A closed surface and the triangles of another, each both ways, so that they enclose nothing.
TriMesh with_loose_triangles(const TriMesh& closed, const TriMesh& loose) {
  TriMesh all;
  all.points.resize(closed.n_vertices() + loose.n_vertices(), 3);
  all.points << closed.points, loose.points;
  const Triangles there = loose.triangles.array() + closed.n_vertices();
  all.triangles.resize(closed.n_triangles() + 2 * loose.n_triangles(), 3);
  all.triangles << closed.triangles, there, there.rowwise().reverse();
  return all;
}

/// The spacing wanted, or as much more as keeps the samples of a large body few enough.
double grid_spacing(const TriMesh& surface, double wanted) {
  constexpr double kMostSamples = 6e7;
  const Bounds box = bounds(surface.points);
  return std::max(wanted, std::cbrt((box.high - box.low).prod() / kMostSamples));
}

/// A new surface around what the old one encloses; nullopt where more than a little would be lost.
std::optional<Rebuilt> made_anew_evenly(const TriMesh& surface) {
  try {
    return rebuild(surface, {.spacing = grid_spacing(surface, kRebuildSpacing),
                             .target_edge = kRebuildEdge,
                             .max_loss = kLargestLoss});
  } catch (const Error& error) {
    if (error.code() != ErrorCode::below_quality) throw;
    return std::nullopt;
  }
}

/// A new surface around what the old one encloses; thin parts that would be lost become walls.
TriMesh made_anew(const TriMesh& surface, const std::string& why,
                  std::vector<std::string>& changes) {
  const double fine = grid_spacing(surface, kThinSpacing), half = kThickening / kThinSpacing * fine;
  std::optional<Rebuilt> even = made_anew_evenly(surface);
  const Rebuilt rebuilt =
      even ? std::move(*even)
           : rebuild(surface, {.spacing = fine, .thickening = half, .target_edge = kThinEdge});
  if (rebuilt.thickened_area > 0.0)
    changes.push_back(join_text("parts too thin to be filled became walls of ", 2.0 * half, " mm"));
  changes.push_back(join_text(
      "made anew around what it encloses since ", why, "; at most ", rebuilt.largest_move,
      " mm from where it was; what is left out reached ", rebuilt.largest_loss, " mm farther"));
  return rebuilt.mesh;
}

/// Repaired, or refused for a reason.
struct Attempt {
  std::optional<Repaired> repaired;
  ErrorCode code = ErrorCode::bad_mesh;
  std::string refusal;
};

Attempt attempt(const TriMesh& surface) {
  try {
    return {repair(surface), ErrorCode::bad_mesh, {}};
  } catch (const Error& refused) {
    return {std::nullopt, refused.code(), refused.what()};
  }
}

/// How far a repair moved the surface, or what it dropped reached, mm.
double moved_by(const Repaired& repaired) {
  return std::max(repaired.report.largest_move, repaired.report.dropped_reach);
}

/// Evens out the places where a closed surface cuts itself, which keeps its triangles, unless that
/// would move it by more than `allowed` mm.
/// @returns whether it was
bool update_evened(TriMesh& surface, double allowed, std::vector<std::string>& changes) {
  TriMesh even = surface;
  if (!update_unfolded(even)) return false;
  const double moved = (even.points - surface.points).rowwise().norm().maxCoeff();
  if (moved > allowed) return false;
  changes.push_back(join_text("evened out where it cut itself, by at most ", moved, " mm"));
  surface = std::move(even);
  return true;
}

/// A surface that cuts itself is mended by whatever moves it least; the rest is repaired.
TriMesh made_valid(TriMesh surface, const ValidityReport& before, const std::string& name,
                   std::vector<std::string>& changes) {
  Attempt tried = attempt(surface);
  if (before.has(FaultKind::self_intersection) && manifold_fault(surface).empty()) {
    const double allowed =
        tried.repaired ? std::min(moved_by(*tried.repaired), kLargestEvening) : kLargestEvening;
    if (update_evened(surface, allowed, changes)) tried = attempt(surface);
  }
  std::optional<Repaired>& repaired = tried.repaired;
  if (!repaired && has_second_body(surface)) fail(tried.code, name, ": ", tried.refusal);
  if (repaired && repaired->report.dropped_reach > kLargestLoss) {
    // parts without volume that reach out are lost by a repair
    tried.refusal =
        join_text("parts without volume reach ", repaired->report.dropped_reach, " mm out");
    surface = with_loose_triangles(repaired->mesh, surface);
  } else if (repaired && repaired->report.largest_move > kLargestLoss) {
    tried.refusal = join_text("a repair would move it by ", repaired->report.largest_move, " mm");
  }
  if (!tried.refusal.empty()) {
    try {
      return made_anew(surface, tried.refusal, changes);
    } catch (const Error& error) {
      if (!repaired) fail(error.code(), name, ": ", tried.refusal, "; ", error.what());
    }
  }
  for (const std::string& line : repaired->report.lines()) changes.push_back(line);
  return repaired->mesh;
}

}  // namespace

TriMesh usable_surface(const TriMesh& surface, const std::string& name, Record& record,
                       const Monitor& monitor) {
  const ValidityReport report = validate(surface);
  if (report.valid()) return surface;
  std::vector<std::string> changes;
  const TriMesh valid = made_valid(surface, report, name, changes);
  for (const std::string& line : changes) {
    record.warnings.push_back(name + ": " + line);
    monitor.warn(record.warnings.back());
  }
  return valid;
}

}  // namespace coxa::pipeline
