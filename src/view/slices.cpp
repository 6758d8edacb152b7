#include <coxa/view/pictures.h>

#include "panel.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa::view {
namespace {

struct Slice {
  const char* name;
  Vec3 right, up;  // LPS directions of the picture
  int axis;        // coordinate that is constant
};
const std::array<Slice, 3> kSlices{{{"axial", Vec3::UnitX(), -Vec3::UnitY(), 2},
                                    {"coronal", Vec3::UnitX(), Vec3::UnitZ(), 1},
                                    {"sagittal", Vec3::UnitY(), Vec3::UnitZ(), 0}}};

struct Window {
  double low, high;
};

Window window_of(const Volume& volume, const SliceOptions& options) {
  // at most about 200 000 voxels say enough about the range
  const auto stride = std::max<std::size_t>(1, volume.values.size() / 200000);
  VecX some(static_cast<Eigen::Index>((volume.values.size() + stride - 1) / stride));
  for (Eigen::Index i = 0; i < some.size(); ++i)
    some[i] = volume.values[static_cast<std::size_t>(i) * stride];
  const Window window{options.window_low.value_or(percentile(some, 0.01)),
                      options.window_high.value_or(percentile(some, 0.995))};
  return window.low < window.high ? window : Window{window.low, window.low + 1.0};
}

class SlicePainter {
 public:
  SlicePainter(const Slice& slice, const Vec3& centre, const SliceOptions& options)
      : slice_(slice),
        centre_(centre),
        options_(options),
        mm_per_pixel_(options.field / options.panel),
        image_(options.panel, options.panel, kBlack) {}

  void paint_volume(const Volume& volume, const Window& window) {
    parallel_for(options_.panel, [&](Index y) {
      for (int x = 0; x < options_.panel; ++x) {
        const double value = sample(volume, position(x + 0.5, y + 0.5));
        if (!std::isnan(value))
          image_.at(x, static_cast<int>(y)) =
              map_colour(ColourMap::grey, (value - window.low) / (window.high - window.low));
      }
    });
  }

  void paint_outline(const TriMesh& mesh, Colour colour) {
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
      std::array<Vec2, 3> crossings;
      int n = 0;
      for (int k = 0; k < 3; ++k) {
        const Vec3 a = mesh.points.row(mesh.triangles(t, k)),
                   b = mesh.points.row(mesh.triangles(t, (k + 1) % 3));
        const double from = a[slice_.axis] - centre_[slice_.axis],
                     to = b[slice_.axis] - centre_[slice_.axis];
        if ((from < 0.0) == (to < 0.0)) continue;
        crossings[static_cast<std::size_t>(n++)] = pixel(a + from / (from - to) * (b - a));
      }
      if (n == 2) update_line(image_, crossings[0], crossings[1], colour, options_.line_thickness);
    }
  }

  Image finished() {
    update_side_letters(image_, slice_.right, slice_.up, kWhite);
    update_scale_bar(image_, mm_per_pixel_, kWhite);
    const char coordinate = "xyz"[slice_.axis];
    return titled(image_, join_text(slice_.name, "  ", coordinate, " = ",
                                    tick_label(centre_[slice_.axis], 0.1), " mm"));
  }

 private:
  Vec3 position(double x, double y) const {
    const double half = 0.5 * options_.panel;
    return centre_ + mm_per_pixel_ * ((x - half) * slice_.right - (y - half) * slice_.up);
  }
  Vec2 pixel(const Vec3& p) const {
    const double half = 0.5 * options_.panel;
    return {half + (p - centre_).dot(slice_.right) / mm_per_pixel_,
            half - (p - centre_).dot(slice_.up) / mm_per_pixel_};
  }

  const Slice& slice_;
  Vec3 centre_;
  const SliceOptions& options_;
  double mm_per_pixel_;
  Image image_;
};

}  // namespace

Image draw_slices(const Volume& volume, const SurfaceSet& surfaces, const Vec3& centre,
                  const SliceOptions& options) {
  require(
      volume.n_voxels() > 0 && static_cast<std::int64_t>(volume.values.size()) == volume.n_voxels(),
      "draw_slices: the volume is empty");
  require(options.panel >= 60, "draw_slices: panel must be at least 60 pixels, got ",
          options.panel);
  require(options.field > 0.0, "draw_slices: field must be positive, got ", options.field, " mm");
  require(options.line_thickness > 0.0, "draw_slices: line_thickness must be positive, got ",
          options.line_thickness);
  require(centre.allFinite(), "draw_slices: the centre is not finite");
  const Window window = window_of(volume, options);
  std::vector<Image> panels;
  std::vector<std::string> names;
  for (const auto& [name, surface] : surfaces) names.push_back(name);
  for (const Slice& slice : kSlices) {
    SlicePainter painter(slice, centre, options);
    painter.paint_volume(volume, window);
    for (const auto& [name, surface] : surfaces)
      painter.paint_outline(surface.mesh, structure_colour(name));
    panels.push_back(painter.finished());
  }
  const Image row = beside(panels);
  return below(std::array{row, draw_legend(names, row.width)}, 4);
}

}  // namespace coxa::view
