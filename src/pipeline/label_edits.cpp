#include "label_edits.h"

#include <coxa/core/error.h>
#include <coxa/io/labels.h>
#include <coxa/mesh/voxelize.h>
#include <coxa/pipeline/label_map.h>
#include <coxa/pipeline/structures.h>
#include <coxa/segment/follow_mask.h>

#include <algorithm>

namespace coxa::pipeline {
namespace {

// mm and direction cosines by which grids that are the same may differ in a file
constexpr double kSamePlace = 0.01, kSameDirection = 1e-3;
// overlap below which a surface is said not to have followed
constexpr double kFollowed = 0.97;

void require_same_grid(const std::filesystem::path& path, const Volume& labels,
                       const Volume& grid) {
  const bool same = labels.size == grid.size &&
                    (labels.spacing - grid.spacing).norm() < kSamePlace &&
                    (labels.origin - grid.origin).norm() < kSamePlace &&
                    (labels.direction - grid.direction).norm() < kSameDirection;
  require(same, path.string(), " does not lie on the image's grid (", labels.size[0], "×",
          labels.size[1], "×", labels.size[2], " voxels, the image has ", grid.size[0], "×",
          grid.size[1], "×", grid.size[2],
          "); export the labels with the image as reference volume");
}

/// The structure each number means: by the names in the file, or by the numbers of our own map.
std::map<int, std::string> meanings(const io::LabelMap& edited, const io::LabelMap& ours) {
  std::map<int, std::string> own, names;
  for (const io::Label& label : ours.labels) own[label.value] = label.name;
  for (const io::Label& label : edited.labels) {
    const bool unnamed = label.name == join_text("label_", label.value);
    names[label.value] = unnamed && own.contains(label.value) ? own[label.value] : label.name;
  }
  return names;
}

/// The voxels of a surface, less what the edited map took away and with what it added.
struct Wanted {
  std::vector<std::uint8_t> mask;
  std::int64_t changed = 0;
};

Wanted wanted_voxels(const std::string& name, const TriMesh& mesh, const io::LabelMap& ours,
                     const io::LabelMap& edited, const std::map<int, std::string>& names) {
  const Volume& grid = edited.volume;
  Wanted wanted{inside_samples(mesh, grid.size, [&](const Vec3& p) { return grid.index(p); })};
  std::array<bool, 256> before{}, after{};
  for (const io::Label& label : ours.labels)
    before[static_cast<std::size_t>(label.value)] = label.name == name;
  for (const auto& [value, meaning] : names)
    after[static_cast<std::size_t>(value)] = meaning == name;
  for (std::size_t i = 0; i < wanted.mask.size(); ++i) {
    const bool was = before[static_cast<std::size_t>(ours.volume.values[i])];
    const bool is = after[static_cast<std::size_t>(grid.values[i])];
    if (was == is) continue;
    wanted.mask[i] = is ? 1 : 0;
    ++wanted.changed;
  }
  return wanted;
}

}  // namespace

void follow_labels(const std::filesystem::path& path, const Volume& grid, SurfaceSet& surfaces,
                   Record& record, const Monitor& monitor) {
  const io::LabelMap edited = io::read_labels(path);
  require_same_grid(path, edited.volume, grid);
  const io::LabelMap ours = make_label_map(grid, surfaces);
  const auto names = meanings(edited, ours);
  for (const auto& [value, name] : names) {
    const bool occurs = std::find(edited.volume.values.begin(), edited.volume.values.end(),
                                  static_cast<float>(value)) != edited.volume.values.end();
    require(!occurs || surfaces.contains(name) || is_generic(name), path.string(), ": label ",
            value, " (", name, ") is none of the structures that were segmented");
  }
  for (auto& [name, surface] : surfaces) {
    monitor.check_cancelled();
    const Wanted wanted = wanted_voxels(name, surface.mesh, ours, edited, names);
    if (wanted.changed == 0) continue;
    require(std::find(wanted.mask.begin(), wanted.mask.end(), 1) != wanted.mask.end(),
            path.string(), " leaves nothing of the ", name,
            "; leave a structure out by --structures instead");
    const Points before = surface.mesh.points;
    const double dice = segment::update_to_mask(surface.mesh, wanted.mask, edited.volume);
    surface.fields["edited_mm"] = (surface.mesh.points - before).rowwise().norm();
    record.figures[name + "_edited_voxels"] = wanted.changed;
    record.figures[name + "_edited_dice"] = dice;
    if (dice >= kFollowed) continue;
    record.warnings.push_back(join_text("the surface of the ", name,
                                        " overlaps its edited labels by ", dice,
                                        " only (Dice): the model cannot take that form"));
    monitor.warn(record.warnings.back());
  }
}

}  // namespace coxa::pipeline
