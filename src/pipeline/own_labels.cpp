#include "own_labels.h"

#include <coxa/core/error.h>
#include <coxa/io/labels.h>
#include <coxa/mesh/iso_surface.h>
#include <coxa/mesh/rebuild.h>
#include <coxa/segment/distance_map.h>
#include <coxa/shape/hip_structures.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "label_map_bones.h"
#include "muscle_examples.h"

namespace coxa::pipeline {
namespace {

/// mm, of the surface's grid: as fine as the voxels within these bounds.
constexpr double kFinestGrid = 0.5, kCoarsestGrid = 1.5;
/// Of the largest spacing: a Gaussian over the depths against the voxels' steps.
constexpr double kEvening = 0.4;
/// Grid steps, of the triangles.
constexpr double kEdge = 2.0;
/// Of the spacing: vertices this near to the map's border lie on its cut.
constexpr double kCutReach = 1.3;
/// Voxels about a structure.
constexpr Index kMargin = 4;

bool is_known(const std::string& name) {
  const auto& muscles = muscle_names();
  return std::find(std::begin(shape::kHipStructures), std::end(shape::kHipStructures), name) !=
             std::end(shape::kHipStructures) ||
         std::find(muscles.begin(), muscles.end(), name) != muscles.end();
}

std::string known_names() {
  std::string text;
  for (const char* name : shape::kHipStructures)
    text += (text.empty() ? "" : ", ") + std::string(name);
  return text + " or a muscle's, as `coxa segment` writes them";
}

struct Cut {
  Volume grid;  ///< a margin of background about the structure
  segment::Mask mask;
};

/// The voxels of a value, with a margin that may reach out of the map; empty where there are none.
Cut cut_out(const Volume& labels, int value) {
  std::array<Index, 3> low = labels.size, high{-1, -1, -1};
  const auto is = [&](Index i, Index j, Index k) {
    return labels.values[static_cast<std::size_t>(labels.offset(i, j, k))] ==
           static_cast<float>(value);
  };
  for (Index k = 0; k < labels.size[2]; ++k) {
    for (Index j = 0; j < labels.size[1]; ++j) {
      for (Index i = 0; i < labels.size[0]; ++i) {
        if (!is(i, j, k)) continue;
        const std::array<Index, 3> at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], at[a] - kMargin);
          high[a] = std::max(high[a], at[a] + kMargin);
        }
      }
    }
  }
  Cut cut;
  if (high[0] < 0) return cut;
  cut.grid = {{high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1},
              labels.spacing,
              labels.position(Vec3(low[0], low[1], low[2])),
              labels.direction,
              {}};
  const auto within = [&](Index at, std::size_t a) { return at >= 0 && at < labels.size[a]; };
  for (Index k = low[2]; k <= high[2]; ++k)
    for (Index j = low[1]; j <= high[1]; ++j)
      for (Index i = low[0]; i <= high[0]; ++i)
        cut.mask.push_back(within(i, 0) && within(j, 1) && within(k, 2) && is(i, j, k));
  return cut;
}

/// Between the voxels where their depths vanish.
TriMesh surface_between(Cut cut) {
  cut.grid.values = segment::depths_in(cut.mask, cut.grid);
  const double spacing = std::clamp(cut.grid.spacing.minCoeff(), kFinestGrid, kCoarsestGrid);
  const Volume even =
      smoothed(resampled_isotropic(cut.grid, spacing), kEvening * cut.grid.spacing.maxCoeff());
  if (*std::max_element(even.values.begin(), even.values.end()) <= 0.0F) return {};
  const TriMesh raw = largest_piece(
      iso_surface(even.size, even.values, 0.0, [&](const Vec3& i) { return even.position(i); }));
  return rebuild(raw, {.spacing = spacing, .target_edge = kEdge * spacing, .max_move = kInfinity})
      .mesh;
}

/// Empty where the map's border does not cut the surface.
VecX cut_trust(const TriMesh& mesh, const Volume& labels) {
  VecX trust = VecX::Ones(mesh.n_vertices());
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 at = labels.index(mesh.points.row(v).transpose());
    for (Index a = 0; a < 3; ++a) {
      const double last = static_cast<double>(labels.size[static_cast<std::size_t>(a)]) - 1.0;
      if (std::min(at[a], last - at[a]) < kCutReach) trust[v] = 0.0;
    }
  }
  return trust.minCoeff() > 0.0 ? VecX{} : trust;
}

}  // namespace

OwnLabels read_own_labels(const std::filesystem::path& path) {
  const io::LabelMap map = io::read_labels(path);
  OwnLabels own;
  for (const io::Label& label : map.labels) {
    // what is made from anatomy is no example of anything
    if (!is_known(label.name) || label.generic) continue;
    Cut cut = cut_out(map.volume, label.value);
    if (cut.mask.empty()) continue;
    TriMesh mesh = surface_between(std::move(cut));
    require(mesh.n_vertices() > 0, path.string(), ": label ", label.value, " (", label.name,
            ") is thinner than its voxels: no surface can be made of it");
    VecX trust = cut_trust(mesh, map.volume);
    if (trust.size() > 0) own.trust[label.name] = std::move(trust);
    own.surfaces[label.name].mesh = std::move(mesh);
  }
  require(!own.surfaces.empty(), path.string(), ": no label has the name of a structure; they are ",
          known_names());
  return own;
}

}  // namespace coxa::pipeline
