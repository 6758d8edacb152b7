#pragma once

#include <coxa/image/volume.h>
#include <coxa/mesh/surface_set.h>
#include <coxa/view/colour_map.h>
#include <coxa/view/image.h>

#include <optional>
#include <string>
#include <vector>

namespace coxa::view {

struct SliceOptions {
  int panel = 420;              ///< pixels, >= 60: side of one of the three panels
  double field = 150.0;         ///< mm, > 0: side of the region shown around the centre
  double line_thickness = 1.6;  ///< pixels, > 0
  /// Value shown black; by default the 1st percentile in the volume.
  std::optional<double> window_low = {};
  /// Value shown white; by default the 99.5th percentile.
  std::optional<double> window_high = {};
};

/// Axial, coronal and sagittal slices through a point side by side, with the outlines of the
/// structures, a legend, orientation letters and a scale bar. The patient's right is on the left of
/// axial and coronal slices, anterior on the left of sagittal ones.
///
/// @param centre  LPS mm; pixels outside the volume are black
/// @throws Error bad_input if the volume is empty or an option is out of range
Image draw_slices(const Volume& volume, const SurfaceSet& surfaces, const Vec3& centre,
                  const SliceOptions& options = {});

/// Where a picture is taken from.
enum class Viewpoint { anterior, posterior, left, right, superior, inferior };

/// A line with a head at its last point, drawn over a picture: an axis, or the way something turns.
struct Arrow {
  Points path;        ///< n×3, mm, n >= 2
  std::string label;  ///< at its head
  Index group = 0;    ///< arrows of a group share a colour
};

struct SurfacePictureOptions {
  std::vector<Viewpoint> viewpoints = {Viewpoint::anterior, Viewpoint::posterior};
  int panel = 420;                            ///< pixels, >= 60: side of a panel
  std::vector<std::string> see_through = {};  ///< structures drawn half transparent
  std::vector<Arrow> arrows = {};             ///< over the surfaces, never hidden by them
};

/// Structures in their colours from one or more sides, with a legend. @throws Error bad_input for
/// an empty set
Image draw_surfaces(const SurfaceSet& surfaces, const SurfacePictureOptions& options = {});

/// One surface coloured by one of its values, with a colour bar.
/// @throws Error bad_input if `values` has neither one per vertex nor one per triangle
Image draw_field(const TriMesh& mesh, const VecX& values, const ColourScale& scale, Viewpoint from,
                 int panel = 420);

/// Colours of a surface at one moment.
struct MapFrame {
  std::string title;  ///< for example "90° flexion, 20° internal rotation"
  VecX values;        ///< per vertex or per triangle
};

/// A joint surface seen from the other bone, once per frame, with one colour bar for all.
///
/// The eye stands at `eye`, say the femoral head's centre, and looks at the middle of the surface.
/// Letters mark anterior, posterior, superior, inferior, left and right as they lie in the picture.
/// @param mesh  articular side of the cartilage, LPS mm
/// @throws Error bad_input if there is no frame or a frame's values fit neither vertices nor
/// triangles
Image strain_map_panel(const TriMesh& mesh, const Vec3& eye, const std::vector<MapFrame>& frames,
                       const ColourScale& scale, int panel = 320);

/// Lowest value and 99th percentile over all frames as the range of a scale; 0 to 1e-6 where
/// nothing is finite.
ColourScale scale_for(const std::vector<MapFrame>& frames, const std::string& label);

}  // namespace coxa::view
