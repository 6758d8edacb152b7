#include <coxa/pipeline/atlas_profiles.h>

#include <coxa/core/error.h>
#include <coxa/image/phantom.h>
#include <coxa/mesh/simplex_mesh.h>
#include <coxa/shape/hip_structures.h>
#include <coxa/shape/profiles.h>
#include <coxa/shape/virtual_hip.h>

#include <algorithm>
#include <deque>
#include <map>

namespace coxa::pipeline {
namespace {

// a right hip lies that far to the right and in front of the body's axis, mm
const Vec3 kBodyFromHip = Vec3(85.0, 20.0, 0.0);
constexpr double kMargin = 12.0;       // mm of image around the surfaces
constexpr double kCortex = 1.0;        // mm, of the hip bone
constexpr double kTouchingGap = 0.05;  // mm
constexpr double kFluidGap = 0.5;      // mm
// images that muscles' profiles are learned on: noise-free, so that where two muscles touch
// nothing is learned
constexpr double kMuscleVoxel = 1.5, kMuscleSample = 1.0;  // mm
constexpr double kFatAround = 400.0;                       // mm, farther than any image reaches
// an example with a smaller share of the muscles has fat where its other muscles are
constexpr double kLeastShare = 0.85;

Contrast contrast_named(const std::string& name) {
  const std::map<std::string, Contrast> known{
      {"t1", Contrast::t1}, {"t2", Contrast::t2}, {"pd", Contrast::pd}, {"dess", Contrast::dess}};
  const auto it = known.find(name);
  require(it != known.end(), "no contrast \"", name, "\"; there are t1, t2, pd, dess");
  return it->second;
}

std::vector<TissueSurface> tissues_of(const shape::VirtualHip& hip) {
  std::vector<TissueSurface> tissues;
  for (const char* name : shape::kHipStructures) {
    const TriMesh& mesh = hip.at(name);
    const bool bone = std::string(name).find("cartilage") == std::string::npos;
    TissueSurface tissue{
        mesh.points, mesh.triangles, bone ? Tissue::marrow : Tissue::cartilage, {}};
    if (std::string(name) == "femur") tissue.shell = shell_thicker_below(mesh.points, Vec3::Zero());
    if (std::string(name) == "hip_bone") tissue.shell = VecX::Constant(mesh.n_vertices(), kCortex);
    tissues.push_back(std::move(tissue));
  }
  return tissues;
}

PhantomOptions phantom_around(const shape::VirtualHip& hip, const AtlasProfileOptions& options) {
  Vec3 low = Vec3::Constant(kInfinity), high = -low;
  for (const auto& [name, mesh] : hip) {
    low = low.cwiseMin(mesh.points.colwise().minCoeff().transpose());
    high = high.cwiseMax(mesh.points.colwise().maxCoeff().transpose());
  }
  PhantomOptions phantom;
  phantom.voxel = Vec3::Constant(options.voxel);
  phantom.field_of_view = high - low + Vec3::Constant(2.0 * kMargin);
  phantom.centre = 0.5 * (low + high);
  phantom.body_centre = kBodyFromHip;
  phantom.bias = 0.0;
  phantom.snr = options.snr;
  return phantom;
}

/// Muscles of an example in the atlas frame; what it lacks is the mean's.
shape::VirtualHip with_means(const shape::Atlas& atlas,
                             const std::map<std::string, TriMesh>& surfaces) {
  shape::VirtualHip hip = surfaces;
  for (const shape::StructureModel& model : atlas.structures) {
    if (model.muscle && !hip.contains(model.name))
      hip[model.name] = dual_surface(model.hierarchy.levels.back());
  }
  return hip;
}

/// Muscles in fat, the mean bones and cartilages among them.
Volume image_of_muscles(const shape::Atlas& atlas, const shape::VirtualHip& muscles,
                        const std::string& contrast, std::uint64_t seed) {
  shape::VirtualHip around = shape::mean_hip(atlas);
  std::vector<TissueSurface> tissues;
  for (const auto& [name, mesh] : muscles)
    tissues.push_back({mesh.points, mesh.triangles, Tissue::muscle, {}});
  for (TissueSurface& tissue : tissues_of(around)) tissues.push_back(std::move(tissue));
  around.insert(muscles.begin(), muscles.end());
  PhantomOptions phantom = phantom_around(around, {.voxel = kMuscleVoxel, .snr = kInfinity});
  phantom.contrast = contrast_named(contrast);
  phantom.texture = 0.0;
  phantom.muscles = false;
  phantom.body_semi_axes = Vec2::Constant(kFatAround);
  phantom.largest_sample = kMuscleSample;
  phantom.seed = seed;
  return simulate_mri(tissues, phantom);
}

}  // namespace

void update_atlas_profiles(shape::Atlas& atlas, const AtlasProfileOptions& options,
                           const Monitor& monitor) {
  require(options.n_hips >= 1, "at least one hip per class of profiles, got ", options.n_hips);
  require(options.voxel > 0.0, "voxel must be positive, got ", options.voxel, " mm");
  // the hips and images are referred to until the profiles are learned: a deque keeps their places
  std::deque<shape::VirtualHip> hips;
  std::deque<Volume> images;
  std::vector<shape::ImagedHip> imaged;
  Rng rng(options.seed);
  const double n_images = 2.0 * options.n_hips * static_cast<double>(options.contrasts.size());
  for (const bool fluid : {false, true}) {
    const double gap = fluid ? kFluidGap : kTouchingGap;
    for (int i = 0; i < options.n_hips; ++i) {
      hips.push_back(shape::draw_virtual_hip(atlas, rng, {.least_gap = gap}));
      for (const std::string& contrast : options.contrasts) {
        PhantomOptions phantom = phantom_around(hips.back(), options);
        phantom.contrast = contrast_named(contrast);
        phantom.joint_filling = fluid ? Tissue::fluid : Tissue::cartilage;
        phantom.seed = options.seed + imaged.size();
        monitor.check_cancelled();
        images.push_back(simulate_mri(tissues_of(hips.back()), phantom));
        imaged.push_back({fluid ? contrast + "_fluid" : contrast, &hips.back(), &images.back()});
        monitor.progress("profiles", static_cast<double>(imaged.size()) / n_images);
      }
    }
  }
  shape::update_profiles(atlas, imaged);
}

void update_muscle_profiles(shape::Atlas& atlas, const std::vector<shape::CarriedMuscles>& examples,
                            const AtlasProfileOptions& options, const Monitor& monitor) {
  const auto n_muscles = static_cast<double>(
      std::count_if(atlas.structures.begin(), atlas.structures.end(),
                    [](const shape::StructureModel& model) { return model.muscle; }));
  if (n_muscles == 0.0) return;
  std::vector<shape::VirtualHip> hips = {with_means(atlas, {})};
  for (const shape::CarriedMuscles& example : examples) {
    if (static_cast<double>(example.surfaces.size()) >= kLeastShare * n_muscles)
      hips.push_back(with_means(atlas, example.surfaces));
  }
  std::vector<std::vector<Volume>> images(options.contrasts.size());
  for (std::size_t c = 0; c < options.contrasts.size(); ++c) {
    for (std::size_t h = 0; h < hips.size(); ++h) {
      monitor.check_cancelled();
      images[c].push_back(image_of_muscles(atlas, hips[h], options.contrasts[c], options.seed + h));
      monitor.progress("muscle profiles", static_cast<double>(c * hips.size() + h + 1) /
                                              static_cast<double>(images.size() * hips.size()));
    }
  }
  for (shape::StructureModel& model : atlas.structures) {
    if (!model.muscle) continue;
    model.profiles.clear();
    for (std::size_t c = 0; c < options.contrasts.size(); ++c) {
      std::vector<shape::ProfileExample> shown;
      for (std::size_t h = 0; h < hips.size(); ++h)
        shown.push_back(shape::profile_example(model, hips[h].at(model.name), images[c][h]));
      model.profiles.push_back(shape::learn_profiles(shown, options.contrasts[c]));
    }
  }
}

}  // namespace coxa::pipeline
