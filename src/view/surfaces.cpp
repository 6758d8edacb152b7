#include <coxa/view/pictures.h>

#include "panel.h"

#include <coxa/core/error.h>
#include <coxa/mesh/measures.h>
#include <coxa/view/render.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa::view {
namespace {

struct Stand {
  const char* name;
  Vec3 direction, up;
};

Stand stand_of(Viewpoint viewpoint) {
  switch (viewpoint) {
    case Viewpoint::anterior:
      return {"from the front", Vec3::UnitY(), Vec3::UnitZ()};
    case Viewpoint::posterior:
      return {"from behind", -Vec3::UnitY(), Vec3::UnitZ()};
    case Viewpoint::left:
      return {"from the left", -Vec3::UnitX(), Vec3::UnitZ()};
    case Viewpoint::right:
      return {"from the right", Vec3::UnitX(), Vec3::UnitZ()};
    case Viewpoint::superior:
      return {"from above", -Vec3::UnitZ(), -Vec3::UnitY()};
    case Viewpoint::inferior:
      return {"from below", Vec3::UnitZ(), -Vec3::UnitY()};
  }
  return {"", Vec3::UnitY(), Vec3::UnitZ()};
}

constexpr Colour kArrowColours[] = {{178, 34, 34}, {0, 90, 160}, {0, 110, 70}, {90, 60, 140}};

void update_arrow(Image& image, const Camera& camera, const Arrow& arrow, int panel) {
  const Colour colour = kArrowColours[arrow.group % std::size(kArrowColours)];
  constexpr double kThickness = 3.0, kHead = 10.0;  // pixels
  std::vector<Vec2> pixels;
  for (Index k = 0; k < arrow.path.rows(); ++k)
    pixels.push_back(project(camera, arrow.path.row(k), panel, panel));
  // what points at the eye would only cover the rest
  constexpr double kShortest = 24.0;  // pixels
  double extent = 0.0;
  for (const Vec2& pixel : pixels) extent = std::max(extent, (pixel - pixels.front()).norm());
  if (extent < kShortest) return;
  for (std::size_t k = 1; k < pixels.size(); ++k)
    update_line(image, pixels[k - 1], pixels[k], colour, kThickness);
  const Vec2 tip = pixels.back(), along = tip - pixels[pixels.size() - 2];
  if (along.norm() > 1.0) {
    const Vec2 back = -kHead * along.normalized();
    for (const double turn : {0.45, -0.45}) {
      const Eigen::Rotation2Dd rotation(turn);
      update_line(image, tip, tip + rotation * back, colour, kThickness);
    }
  }
  const double width = text_width(arrow.label, kTextSize);
  const double x = std::clamp(tip.x() + (along.x() < 0 ? -width - 6.0 : 6.0), 2.0,
                              std::max(2.0, panel - width - 2.0));
  const double y = std::clamp(tip.y() + (along.y() > 0 ? 4.0 : -4.0 - line_height(kTextSize)), 2.0,
                              panel - line_height(kTextSize));
  update_text(image, x, y, arrow.label, colour, kTextSize);
}

Image panel_of(const std::vector<SceneMesh>& scene, Camera camera, int panel,
               const std::vector<Arrow>& arrows = {}) {
  camera.view_height *= 1.0 + 2.0 * line_height(kTextSize) / panel;  // room for the letters
  Image image = render(scene, camera, {.width = panel, .height = panel});
  for (const Arrow& arrow : arrows) update_arrow(image, camera, arrow, panel);
  update_side_letters(image, camera.right(), camera.up, kInk);
  update_scale_bar(image, camera.view_height / panel, kInk);
  return image;
}

SceneMesh coloured(const TriMesh& mesh, const VecX& values, const ColourScale& scale) {
  SceneMesh part{.mesh = mesh, .scale = scale, .relief = 0.3};
  if (values.size() == mesh.n_vertices()) {
    part.vertex_values = values;
  } else {
    require(values.size() == mesh.n_triangles(), "picture of a field: ", values.size(),
            " values for ", mesh.n_vertices(), " vertices and ", mesh.n_triangles(), " triangles");
    part.triangle_values = values;
  }
  return part;
}

}  // namespace

Image draw_surfaces(const SurfaceSet& surfaces, const SurfacePictureOptions& options) {
  require(!surfaces.empty(), "draw_surfaces: there is no surface");
  require(!options.viewpoints.empty(), "draw_surfaces: there is no viewpoint");
  require(options.panel >= 60, "draw_surfaces: panel must be at least 60 pixels, got ",
          options.panel);
  std::vector<SceneMesh> scene;
  std::vector<std::string> names;
  Index n_points = 0;
  for (const auto& [name, surface] : surfaces) {
    const bool clear = std::count(options.see_through.begin(), options.see_through.end(), name) > 0;
    scene.push_back(
        {.mesh = surface.mesh, .colour = structure_colour(name), .opacity = clear ? 0.4 : 1.0});
    names.push_back(name);
    n_points += surface.mesh.n_vertices();
  }
  for (const Arrow& arrow : options.arrows) {
    require(arrow.path.rows() >= 2, "draw_surfaces: the arrow '", arrow.label,
            "' needs at least two points");
    n_points += static_cast<Index>(arrow.path.rows());
  }
  Points all(n_points, 3);
  Index row = 0;
  for (const SceneMesh& part : scene) {
    all.middleRows(row, part.mesh.n_vertices()) = part.mesh.points;
    row += part.mesh.n_vertices();
  }
  for (const Arrow& arrow : options.arrows) {
    all.middleRows(row, arrow.path.rows()) = arrow.path;
    row += static_cast<Index>(arrow.path.rows());
  }
  std::vector<Image> panels;
  for (Viewpoint viewpoint : options.viewpoints) {
    const Stand stand = stand_of(viewpoint);
    panels.push_back(titled(panel_of(scene, camera_for(all, stand.direction, stand.up, 1.0),
                                     options.panel, options.arrows),
                            stand.name));
  }
  const Image pictures = beside(panels);
  return below(std::array{pictures, draw_legend(names, pictures.width)}, 4);
}

Image draw_field(const TriMesh& mesh, const VecX& values, const ColourScale& scale, Viewpoint from,
                 int panel) {
  require(panel >= 120, "draw_field: panel must be at least 120 pixels, got ", panel);
  const Stand stand = stand_of(from);
  const Image picture = panel_of({coloured(mesh, values, scale)},
                                 camera_for(mesh.points, stand.direction, stand.up, 1.0), panel);
  return beside(std::array{picture, draw_colour_bar(scale, panel)}, 12);
}

Image strain_map_panel(const TriMesh& mesh, const Vec3& eye, const std::vector<MapFrame>& frames,
                       const ColourScale& scale, int panel) {
  require(!frames.empty(), "strain_map_panel: there is no frame");
  require(panel >= 120, "strain_map_panel: panel must be at least 120 pixels, got ", panel);
  if (mesh.empty()) fail(ErrorCode::bad_mesh, "strain_map_panel: the surface has no triangle");
  // towards the area's middle; upwards is superior unless one looks straight up or down
  const VecX areas = triangle_areas(mesh);
  Vec3 middle = Vec3::Zero();
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    middle += areas[t] / areas.sum() *
              mesh.points(mesh.triangles.row(t), Eigen::all).colwise().mean().transpose();
  const Vec3 direction = (middle - eye).normalized();
  const Vec3 up = std::abs(direction[2]) < 0.95 ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitY());
  const Camera camera = camera_for(mesh.points, direction, up, 1.0);
  std::vector<Image> panels;
  for (const MapFrame& frame : frames)
    panels.push_back(
        titled(panel_of({coloured(mesh, frame.values, scale)}, camera, panel), frame.title));
  panels.push_back(draw_colour_bar(scale, panels.front().height));
  return beside(panels, 10);
}

ColourScale scale_for(const std::vector<MapFrame>& frames, const std::string& label) {
  std::vector<double> finite;
  for (const MapFrame& frame : frames)
    for (double value : frame.values)
      if (std::isfinite(value)) finite.push_back(value);
  ColourScale scale{.map = ColourMap::viridis, .low = 0.0, .high = 1e-6, .label = label};
  if (finite.empty()) return scale;
  scale.low = *std::min_element(finite.begin(), finite.end());
  scale.high = percentile(
      Eigen::Map<const VecX>(finite.data(), static_cast<Eigen::Index>(finite.size())), 0.99);
  if (!(scale.high > scale.low))
    scale.high = scale.low + std::max(1e-6, 1e-6 * std::abs(scale.low));
  return scale;
}

}  // namespace coxa::view
