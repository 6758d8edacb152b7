#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/surface_set.h>

#include <string>
#include <vector>

namespace coxa::segment {

/// A closed surface with its fields, and how well the image confirms it.
struct Separable {
  std::string name;
  Surface* surface = nullptr;
  double confirmed = 0.0;
  /// Its triangles are uneven: it gets new ones in any case. The fields are those of `fields_of`.
  bool uneven = false;
  const Surface* fields_of = nullptr;  ///< null: its own
};

/// Takes overlaps of soft bodies away: where two overlap, what the image confirms less gives way,
/// and all do to firm ones. The best confirmed of them stay as they are.
///
/// Surfaces that give way get new triangles; their fields are those of the nearest old places.
/// @returns a text for each of which much lay in others; it stays as it is where nearly all did
/// @note bit-identical for any number of threads
std::vector<std::string> update_separated(std::vector<Separable> soft,
                                          const std::vector<const TriMesh*>& firm,
                                          const Monitor& monitor = {});

}  // namespace coxa::segment
