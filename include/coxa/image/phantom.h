#pragma once

#include <coxa/core/monitor.h>
#include <coxa/image/volume.h>

#include <optional>
#include <vector>

namespace coxa {

/// What gives the signal at a place.
enum class Tissue {
  air,
  fat,
  muscle,
  marrow,
  cortical_bone,
  cartilage,
  fluid,
  fibrous,  ///< labrum, capsule, ligament, tendon
  skin
};

/// Kind of image: spin echo (T1, T2, proton density) or double-echo steady state with water
/// excitation.
enum class Contrast { t1, t2, pd, dess };

/// Signal of water and of fat protons, arbitrary common unit.
struct Signal {
  double water = 0.0;
  double fat = 0.0;
};

/// Signal of a tissue by the sequence's signal equation and relaxation times at 1.5 T.
///
/// Source: relaxation times Gold et al. 2004 (AJR 183:343), completed as docs/image.md says.
Signal tissue_signal(Tissue tissue, Contrast contrast);

/// A closed surface filled with one tissue.
struct TissueSurface {
  Points points;        ///< V×3, LPS mm
  Triangles triangles;  ///< T×3, closed
  Tissue tissue = Tissue::muscle;
  VecX shell;  ///< mm, V values: thickness of cortical bone just inside the surface; empty: none
};

/// Shell of a long bone that hangs down from `centre`: `thin` mm near it, `thick` mm at its shaft.
///
/// The thickness rises linearly between 60 and 110 mm below `centre` along the LPS z axis.
VecX shell_thicker_below(const Points& points, const Vec3& centre, double thin = 1.0,
                         double thick = 5.0);

struct PhantomOptions {
  Contrast contrast = Contrast::t1;
  Vec3 voxel = Vec3::Constant(0.8);          ///< mm, the third is the slice thickness
  Vec3 field_of_view = Vec3::Constant(150);  ///< mm along the grid's axes
  std::optional<Vec3> centre;   ///< LPS mm of the grid; unset: middle of the surfaces' box
  Vec3 oblique = Vec3::Zero();  ///< rotation vector (rad) that turns the grid out of the LPS axes
  double snr = 20.0;       ///< signal of muscle divided by the noise of one channel; infinity: none
  double bias = 0.25;      ///< largest relative deviation of the coil shading, in [0, 1)
  double texture = 0.05;   ///< relative standard deviation of the tissues' own variation
  double fat_shift = 0.0;  ///< mm along the first grid axis by which fat is misplaced
  Tissue joint_filling =
      Tissue::cartilage;            ///< between two cartilages that lie nearer than joint_reach
  double joint_reach = 1.0;         ///< mm
  std::optional<Vec3> body_centre;  ///< LPS mm, on the body's axis; unset: the grid's centre
  Vec2 body_semi_axes = Vec2(170.0, 115.0);  ///< mm, transverse and sagittal, to the skin
  double subcutaneous_fat = 18.0;            ///< mm under the skin
  bool muscles = true;                       ///< spindles of muscle in the body; false: fat alone
  double largest_sample = 0.45;              ///< mm, > 0, between sub-voxel samples
  std::uint64_t seed = 1;                    ///< of muscles, shading, texture and noise
};

/// Simulated magnitude MRI of surfaces in a body of muscles, fat and skin; the mean of muscle is
/// 100.
///
/// Partial volume by signed distances on sub-voxel samples. Surfaces given
/// later cover earlier ones. Muscles are random spindles parted by fat. Noise is Rician.
/// @throws Error bad_input if an option is out of range or a surface is empty
/// @note bit-identical for any number of threads; a whole hip at 0.8 mm takes about 11 s of one
/// core
Volume simulate_mri(const std::vector<TissueSurface>& surfaces, const PhantomOptions& options = {},
                    const Monitor& monitor = {});

}  // namespace coxa
