#include <coxa/segment/cortex_search.h>

#include <coxa/core/parallel.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "coverage_rays.h"

namespace coxa::segment {
namespace {

// 16 mm inwards to 1.5 mm outwards
const ProfileGrid kGrid{-16.0, 0.5, 36};
// the border's own cortex lies from there outwards; a line of another border farther in than this
constexpr double kBorder = -2.5, kFartherIn = -4.0;
// marrow lies in between for a bone in place, mm
constexpr double kMarrowFrom = -7.0, kMarrowTo = -4.0;
// dark is within this share of the way from cortex to marrow
constexpr double kDark = 0.2;
// this share of the vertices has its cortex where it is looked for
constexpr double kInPlace = 0.25;
// passes of means with the neighbours, and the weight of vertices that say nothing
constexpr int kPasses = 60;
constexpr double kSilent = 0.02;

double darkest_at_border(const VecX& line) {
  return line.tail(kGrid.n - kGrid.index_at(kBorder)).minCoeff();
}

/// Shift to the outermost dark line inside, mm; 0 where the border is dark itself; none where there
/// is no dark line at all.
std::optional<double> shift_of(const VecX& line, double dark) {
  if (darkest_at_border(line) < dark) return 0.0;
  for (Index i = kGrid.index_at(kFartherIn); i > 0; --i) {
    if (line[i] >= dark) continue;
    Index end = i;
    while (end > 0 && line[end - 1] < dark) --end;
    // marrow follows a cortex: a darkness that goes on is no bone's border
    if (end == 0) return std::nullopt;
    return kGrid.at(i);
  }
  return std::nullopt;
}

}  // namespace

Points drawn_to_cortex(const Body& bone, std::span<const PreparedImage> images) {
  const SimplexMesh mesh = finest_mesh(bone);
  const Points normals = simplex_normals(mesh);
  const Index n = mesh.n_vertices();
  std::vector<std::optional<VecX>> lines(static_cast<std::size_t>(n));
  parallel_for(n, [&](Index v) {
    for (std::size_t i = 0; i < images.size() && !lines[static_cast<std::size_t>(v)]; ++i)
      lines[static_cast<std::size_t>(v)] =
          profile_along(images[i].volume, mesh.points.row(v), normals.row(v), kGrid);
  });
  std::vector<double> borders, marrows;
  for (const auto& line : lines) {
    if (!line) continue;
    borders.push_back(darkest_at_border(*line));
    const Index from = kGrid.index_at(kMarrowFrom);
    marrows.push_back(line->segment(from, kGrid.index_at(kMarrowTo) - from + 1).mean());
  }
  if (borders.empty()) return bone.points;
  const double cortex = quantile(borders, kInPlace), marrow = quantile(marrows, 0.5);
  const double dark = cortex + kDark * (marrow - cortex);
  if (marrow <= cortex) return bone.points;
  VecX shift = VecX::Zero(n);
  VecX weight = VecX::Constant(n, kSilent);
  for (Index v = 0; v < n; ++v) {
    const auto& line = lines[static_cast<std::size_t>(v)];
    const auto found = line ? shift_of(*line, dark) : std::nullopt;
    if (!found) continue;
    shift[v] = *found;
    weight[v] = 1.0;
  }
  for (int pass = 0; pass < kPasses; ++pass) {
    const VecX before = shift;
    const VecX weight_before = weight;
    parallel_for(n, [&](Index v) {
      double sum = weight_before[v] * before[v], total = weight_before[v];
      for (int k = 0; k < 3; ++k) {
        const Index w = mesh.neighbours(v, k);
        sum += weight_before[w] * before[w];
        total += weight_before[w];
      }
      shift[v] = sum / total;
      weight[v] = 0.25 * total;
    });
  }
  return bone.points + shift.asDiagonal() * normals;
}

}  // namespace coxa::segment
