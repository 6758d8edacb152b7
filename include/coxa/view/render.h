#pragma once

#include <coxa/mesh/tri_mesh.h>
#include <coxa/view/colour_map.h>
#include <coxa/view/image.h>

#include <vector>

namespace coxa::view {

/// A surface in a scene: one colour, or values shown by a colour scale.
struct SceneMesh {
  TriMesh mesh;
  Colour colour{200, 200, 200};
  VecX vertex_values = {};    ///< V values, interpolated, or empty
  VecX triangle_values = {};  ///< T values, or empty; used where vertex_values is empty
  ColourScale scale = {};     ///< for values; NaN shows grey
  double opacity = 1.0;       ///< in [0, 1]
  double relief = 0.65;       ///< in [0, 1]: brightness lost where the surface is seen edge-on
};

/// Parallel projection: no foreshortening, sizes can be measured in the picture.
struct Camera {
  Vec3 target = Vec3::Zero();      ///< mm, at the picture's middle
  Vec3 direction = Vec3::UnitY();  ///< unit, from the eye into the scene
  Vec3 up = Vec3::UnitZ();         ///< unit, perpendicular to direction: upwards in the picture
  double view_height = 200.0;      ///< mm that the picture's height shows

  Vec3 right() const;  ///< unit, rightwards in the picture
};

/// Camera that shows all points, looking along `direction`; `up` is made perpendicular to it.
/// @param aspect  picture width over height
Camera camera_for(const Points& points, const Vec3& direction, const Vec3& up, double aspect);

/// Pixel at which a point appears. (0.5, 0.5) is the first pixel's middle.
Vec2 project(const Camera& camera, const Vec3& point, int width, int height);

struct RenderOptions {
  int width = 800;   ///< pixels, > 0
  int height = 600;  ///< pixels, > 0
  int samples = 2;   ///< >= 1: samples per pixel along each side
  Colour background = kWhite;
};

/// Picture of surfaces by casting rays; needs no display and no graphics card.
///
/// Lit from beside the eye, smooth between vertices, both sides of a triangle visible. Transparent
/// surfaces let what lies behind shine through, front to back.
/// @throws Error bad_input for options out of range, or values of another number than vertices or
/// triangles
/// @note bit-identical for any number of threads
Image render(const std::vector<SceneMesh>& scene, const Camera& camera,
             const RenderOptions& options = {});

}  // namespace coxa::view
