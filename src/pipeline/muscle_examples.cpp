#include "muscle_examples.h"

#include <coxa/image/volume.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/volumes.h>

#include "label_map_bones.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

// the labels of pelvic_ref that are one muscle each; of biceps femoris the short head begins below
// these images
const std::map<float, std::string>& labelled_muscles() {
  static const std::map<float, std::string> names = {
      {5.0F, "gluteus_maximus"},    {6.0F, "gluteus_medius"},
      {7.0F, "gluteus_minimus"},    {8.0F, "iliacus"},
      {9.0F, "obturator_externus"}, {10.0F, "obturator_internus"},
      {11.0F, "pectineus"},         {12.0F, "piriformis"},
      {13.0F, "psoas_major"},       {15.0F, "biceps_femoris_long"},
      {16.0F, "gracilis"},          {17.0F, "rectus_femoris"},
      {18.0F, "sartorius"},         {19.0F, "semimembranosus"},
      {20.0F, "semitendinosus"},    {21.0F, "tensor_fasciae_latae"},
      {23.0F, "vastus_medialis"}};
  return names;
}

// less than this is a stump from which nothing can be learned, mm³
constexpr double kLeastVolume = 8000.0;
// mm around a muscle's voxels
constexpr double kMargin = 6.0;
// vertices this near to the map's first or last slice lie on its cut, mm
constexpr double kCutReach = 4.0;

struct Box {
  std::array<Index, 3> low{0, 0, 0}, high{-1, -1, -1};
  std::int64_t count = 0;
};

std::map<float, Box> boxes_of(const Volume& labels, Side side, double middle) {
  std::map<float, Box> boxes;
  for (Index k = 0; k < labels.size[2]; ++k) {
    for (Index j = 0; j < labels.size[1]; ++j) {
      for (Index i = 0; i < labels.size[0]; ++i) {
        const float label = labels.values[static_cast<std::size_t>(labels.offset(i, j, k))];
        if (!labelled_muscles().contains(label)) continue;
        if ((labels.position(Vec3(i, j, k)).x() > middle) != (side == Side::left)) continue;
        const std::array<Index, 3> at{i, j, k};
        Box& box = boxes[label];
        for (std::size_t a = 0; a < 3; ++a) {
          box.low[a] = box.count == 0 ? at[a] : std::min(box.low[a], at[a]);
          box.high[a] = std::max(box.high[a], at[a]);
        }
        ++box.count;
      }
    }
  }
  return boxes;
}

/// The voxels with a label on one side, cut out of the map with a margin.
Volume cut_out(const Volume& labels, float label, Box box, Side side, double middle) {
  for (std::size_t a = 0; a < 3; ++a) {
    const auto margin = static_cast<Index>(std::ceil(kMargin / labels.spacing[Index(a)]));
    box.low[a] = std::max<Index>(0, box.low[a] - margin);
    box.high[a] = std::min(labels.size[a] - 1, box.high[a] + margin);
  }
  Volume part = labels;
  part.origin = labels.position(Vec3(box.low[0], box.low[1], box.low[2]));
  for (std::size_t a = 0; a < 3; ++a) part.size[a] = box.high[a] - box.low[a] + 1;
  part.values.assign(static_cast<std::size_t>(part.n_voxels()), 0.0F);
  for (Index k = 0; k < part.size[2]; ++k) {
    for (Index j = 0; j < part.size[1]; ++j) {
      for (Index i = 0; i < part.size[0]; ++i) {
        const auto from = labels.offset(i + box.low[0], j + box.low[1], k + box.low[2]);
        const bool on_left = part.position(Vec3(i, j, k)).x() > middle;
        if (labels.values[static_cast<std::size_t>(from)] == label &&
            on_left == (side == Side::left))
          part.values[static_cast<std::size_t>(part.offset(i, j, k))] = 1.0F;
      }
    }
  }
  return part;
}

/// Trust of a surface cut where the map ends; empty where it is whole.
VecX cut_trust(const TriMesh& mesh, const Volume& labels) {
  VecX trust(mesh.n_vertices());
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const double slice = labels.index(mesh.points.row(v)).z();
    const double from_end = labels.spacing.z() * std::min(slice, labels.size[2] - 1.0 - slice);
    trust[v] = from_end > kCutReach ? 1.0 : 0.0;
  }
  return trust.minCoeff() > 0.0 ? VecX{} : trust;
}

}  // namespace

const std::vector<std::string>& muscle_names() {
  static const std::vector<std::string> names = {"gluteus_maximus",     "gluteus_medius",
                                                 "gluteus_minimus",     "tensor_fasciae_latae",
                                                 "sartorius",           "rectus_femoris",
                                                 "vastus_lateralis",    "vastus_medialis",
                                                 "vastus_intermedius",  "iliacus",
                                                 "psoas_major",         "pectineus",
                                                 "adductor_brevis",     "adductor_longus",
                                                 "adductor_magnus",     "gracilis",
                                                 "biceps_femoris_long", "biceps_femoris_short",
                                                 "semitendinosus",      "semimembranosus",
                                                 "piriformis",          "obturator_externus",
                                                 "obturator_internus",  "quadratus_femoris",
                                                 "gemellus_superior",   "gemellus_inferior"};
  return names;
}

SurfaceSet read_muscles(const fs::path& folder) {
  SurfaceSet muscles;
  for (const std::string& name : muscle_names()) {
    const fs::path path = folder / (name + ".ply");
    if (fs::exists(path)) muscles[name].mesh = io::read_surface(path);
  }
  return muscles;
}

std::map<std::string, shape::TrustedSurface> muscles_from_labels(const fs::path& path, Side side) {
  const Volume labels = io::read_volume(path);
  const double middle = middle_of_pelvis(labels);
  const double voxel = labels.spacing.prod();
  std::map<std::string, shape::TrustedSurface> muscles;
  for (const auto& [label, box] : boxes_of(labels, side, middle)) {
    if (static_cast<double>(box.count) * voxel < kLeastVolume) continue;
    shape::TrustedSurface surface{surface_of_mask(cut_out(labels, label, box, side, middle)), {}};
    surface.trust = cut_trust(surface.mesh, labels);
    muscles[labelled_muscles().at(label)] = std::move(surface);
  }
  return muscles;
}

}  // namespace coxa::pipeline
