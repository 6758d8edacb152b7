#include <coxa/image/phantom.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>
#include <coxa/geom/fits.h>

#include "phantom_body.h"
#include "phantom_layer.h"
#include "smooth_noise.h"

#include <algorithm>
#include <cmath>

namespace coxa {
namespace {

constexpr double kTile = 12.0;  ///< mm, side of the tiles for which near muscles are gathered
constexpr Index kBatch = 16;    ///< slices between two reports of progress
constexpr double kMuscleLevel = 100.0;  ///< mean signal of muscle in the image

void check(const std::vector<TissueSurface>& surfaces, const PhantomOptions& options) {
  require(!surfaces.empty(), "a phantom needs at least one surface");
  for (const TissueSurface& surface : surfaces) {
    require(surface.triangles.rows() > 0, "a surface of the phantom has no triangle");
    require(surface.shell.size() == 0 || surface.shell.size() == surface.points.rows(),
            "shell has ", surface.shell.size(), " values, its surface ", surface.points.rows(),
            " vertices");
  }
  require(options.voxel.minCoeff() > 0.0, "voxel must be positive, got ", options.voxel.transpose(),
          " mm");
  require((options.field_of_view.array() >= options.voxel.array()).all(), "field_of_view ",
          options.field_of_view.transpose(), " mm is smaller than a voxel");
  require(options.snr > 0.0, "snr must be positive, got ", options.snr);
  require(0.0 <= options.bias && options.bias < 1.0, "bias must be in [0, 1), got ", options.bias);
  require(options.largest_sample > 0.0, "largest_sample must be positive, got ",
          options.largest_sample, " mm");
  require(options.texture >= 0.0, "texture must not be negative, got ", options.texture);
  require(options.joint_reach >= 0.0, "joint_reach must not be negative, got ",
          options.joint_reach);
  require(options.body_semi_axes.minCoeff() > 0.0, "body_semi_axes must be positive");
}

Volume make_grid(const std::vector<TissueSurface>& surfaces, const PhantomOptions& options) {
  Vec3 low = Vec3::Constant(kInfinity), high = -low;
  for (const TissueSurface& surface : surfaces) {
    low = low.cwiseMin(surface.points.colwise().minCoeff().transpose());
    high = high.cwiseMax(surface.points.colwise().maxCoeff().transpose());
  }
  Volume grid;
  grid.spacing = options.voxel;
  grid.direction = rotation_from_vector(options.oblique);
  Vec3 last;
  for (Index a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    grid.size[i] =
        static_cast<Index>(std::floor(options.field_of_view[a] / options.voxel[a] + 1e-6));
    last[a] = grid.size[i] - 1;
  }
  const Vec3 centre = options.centre.value_or(0.5 * (low + high));
  grid.origin = centre - grid.direction * (0.5 * last).cwiseProduct(grid.spacing);
  return grid;
}

double coverage(double depth, double width) { return std::clamp(0.5 + depth / width, 0.0, 1.0); }

void update_mixed(Signal& signal, const Signal& other, double share) {
  signal.water += share * (other.water - signal.water);
  signal.fat += share * (other.fat - signal.fat);
}

/// Draws water and fat of one slice after the other.
class SlicePainter {
 public:
  SlicePainter(const std::vector<TissueSurface>& surfaces, const PhantomOptions& options,
               const Volume& grid)
      : options_(options),
        grid_(grid),
        body_(options, options.body_centre.value_or(grid_centre(grid))) {
    for (int a = 0; a < 3; ++a) {
      samples_[a] = static_cast<Index>(std::ceil(grid.spacing[a] / options.largest_sample));
      step_[a] = grid.spacing[a] / samples_[a];
    }
    width_ = step_.maxCoeff();
    for (const TissueSurface& surface : surfaces) {
      const bool has_shell = surface.shell.size() > 0;
      const VecX shell = has_shell ? surface.shell : VecX::Zero(surface.points.rows());
      const double band = std::max(options.joint_reach, shell.maxCoeff()) + width_;
      const Points local = (surface.points.rowwise() - grid.origin.transpose()) * grid.direction;
      layers_.emplace_back(local, surface.triangles, shell, band);
      inside_.push_back(tissue_signal(surface.tissue, options.contrast));
      is_cartilage_.push_back(surface.tissue == Tissue::cartilage);
      has_shell_.push_back(has_shell);
    }
    bone_ = tissue_signal(Tissue::cortical_bone, options.contrast);
    cartilage_ = tissue_signal(Tissue::cartilage, options.contrast);
    filling_ = tissue_signal(options.joint_filling, options.contrast);
  }

  static Vec3 grid_centre(const Volume& grid) {
    return grid.position(0.5 * Vec3(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1));
  }

  /// Mean water and fat of every voxel of slice k.
  std::vector<Signal> paint(Index k) const {
    const std::vector<Signal> background = paint_body(k);
    std::vector<Signal> slice(background.size());
    LayerGrid layer;
    layer.nx = grid_.size[0] * samples_[0];
    layer.ny = grid_.size[1] * samples_[1];
    layer.dx = step_[0];
    layer.dy = step_[1];
    layer.x0 = 0.5 * (step_[0] - grid_.spacing[0]);
    layer.y0 = 0.5 * (step_[1] - grid_.spacing[1]);
    std::vector<std::vector<double>> distances(layers_.size(), std::vector<double>(layer.size()));
    std::vector<std::vector<double>> shells = distances;
    const double share = 1.0 / (samples_[0] * samples_[1] * samples_[2]);
    for (Index s = 0; s < samples_[2]; ++s) {
      const double z = (k - 0.5) * grid_.spacing[2] + (s + 0.5) * step_[2];
      for (std::size_t n = 0; n < layers_.size(); ++n)
        layers_[n].rasterise(layer, z, distances[n], shells[n]);
      std::size_t at = 0;
      for (Index y = 0; y < layer.ny; ++y) {
        const std::size_t row =
            static_cast<std::size_t>(y / samples_[1]) * static_cast<std::size_t>(grid_.size[0]);
        for (Index x = 0; x < layer.nx; ++x, ++at) {
          const std::size_t voxel = row + static_cast<std::size_t>(x / samples_[0]);
          Signal signal = background[voxel];
          update_sample(signal, distances, shells, at);
          slice[voxel].water += share * signal.water;
          slice[voxel].fat += share * signal.fat;
        }
      }
    }
    return slice;
  }

 private:
  std::vector<Signal> paint_body(Index k) const {
    const Index nx = grid_.size[0], ny = grid_.size[1];
    std::vector<Signal> slice(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny));
    const double width = std::cbrt(grid_.spacing.prod());
    const Index tx = std::max<Index>(1, static_cast<Index>(kTile / grid_.spacing[0]));
    const Index ty = std::max<Index>(1, static_cast<Index>(kTile / grid_.spacing[1]));
    for (Index j0 = 0; j0 < ny; j0 += ty) {
      for (Index i0 = 0; i0 < nx; i0 += tx) {
        const PhantomBody tile =
            body_.near(grid_.position(Vec3(i0 + 0.5 * tx, j0 + 0.5 * ty, k)), kTile);
        for (Index j = j0; j < std::min(ny, j0 + ty); ++j) {
          for (Index i = i0; i < std::min(nx, i0 + tx); ++i) {
            slice[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) +
                  static_cast<std::size_t>(i)] = tile.signal(grid_.position(Vec3(i, j, k)), width);
          }
        }
      }
    }
    return slice;
  }

  /// Lays the joint space and every surface over the background of one sample.
  void update_sample(Signal& signal, const std::vector<std::vector<double>>& distances,
                     const std::vector<std::vector<double>>& shells, std::size_t at) const {
    double first = kInfinity, second = kInfinity;
    bool first_cartilage = false, second_cartilage = false;
    for (std::size_t n = 0; n < layers_.size(); ++n) {
      if (!is_cartilage_[n] && !has_shell_[n]) continue;
      const double d = distances[n][at];
      if (d < first) {
        second = first;
        second_cartilage = first_cartilage;
        first = d;
        first_cartilage = is_cartilage_[n];
      } else if (d < second) {
        second = d;
        second_cartilage = is_cartilage_[n];
      }
    }
    if (second < options_.joint_reach && (first_cartilage || second_cartilage)) {
      update_mixed(signal, first_cartilage && second_cartilage ? filling_ : cartilage_,
                   coverage(options_.joint_reach - second, width_));
    }
    for (std::size_t n = 0; n < layers_.size(); ++n) {
      const double depth = -distances[n][at];
      const double covered = coverage(depth, width_);
      if (covered <= 0.0) continue;
      Signal inside = inside_[n];
      if (has_shell_[n]) update_mixed(inside, bone_, coverage(shells[n][at] - depth, width_));
      update_mixed(signal, inside, covered);
    }
  }

  const PhantomOptions& options_;
  const Volume& grid_;
  PhantomBody body_;
  Index samples_[3];
  Vec3 step_;
  double width_ = 0.0;
  std::vector<LayeredSurface> layers_;
  std::vector<Signal> inside_;
  std::vector<bool> is_cartilage_, has_shell_;
  Signal bone_, cartilage_, filling_;
};

/// Fat at voxel i comes from `shift` voxels before it.
double shifted_fat(const std::vector<Signal>& slice, std::size_t row, Index i, Index nx,
                   double shift) {
  const double x = std::clamp(i - shift, 0.0, nx - 1.0);
  const auto low = static_cast<Index>(x);
  const Index high = std::min(low + 1, nx - 1);
  const double a = slice[row + static_cast<std::size_t>(low)].fat,
               b = slice[row + static_cast<std::size_t>(high)].fat;
  return a + (x - low) * (b - a);
}

}  // namespace

VecX shell_thicker_below(const Points& points, const Vec3& centre, double thin, double thick) {
  constexpr double kBegin = 60.0,
                   kEnd = 110.0;  // mm below the centre: neck and trochanters lie above
  const Eigen::ArrayXd below = (centre[2] - points.col(2).array() - kBegin) / (kEnd - kBegin);
  return thin + (thick - thin) * below.max(0.0).min(1.0);
}

Volume simulate_mri(const std::vector<TissueSurface>& surfaces, const PhantomOptions& options,
                    const Monitor& monitor) {
  check(surfaces, options);
  Volume image = make_grid(surfaces, options);
  image.values.resize(static_cast<std::size_t>(image.n_voxels()));
  const SlicePainter painter(surfaces, options, image);
  const Signal muscle = tissue_signal(Tissue::muscle, options.contrast);
  const double scale = kMuscleLevel / (muscle.water + muscle.fat);
  const double sigma = kMuscleLevel / options.snr;
  const double shift = options.fat_shift / options.voxel[0];
  const CoilShading shading(options.bias, SlicePainter::grid_centre(image),
                            0.5 * options.field_of_view.maxCoeff(), options.seed + 101);
  const Index nx = image.size[0], ny = image.size[1];
  const auto draw = [&](Index k) {
    const std::vector<Signal> slice = painter.paint(k);
    Rng rng(options.seed * 1000003ULL + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(k + 1));
    for (Index j = 0; j < ny; ++j) {
      const std::size_t row = static_cast<std::size_t>(j) * static_cast<std::size_t>(nx);
      for (Index i = 0; i < nx; ++i) {
        const Vec3 p = image.position(Vec3(i, j, k));
        const double texture =
            smooth_noise(p, 3.5, options.seed + 201) + smooth_noise(p, 11.0, options.seed + 202);
        const double tissue =
            slice[row + static_cast<std::size_t>(i)].water + shifted_fat(slice, row, i, nx, shift);
        const double clean =
            scale * tissue * (1.0 + options.texture * texture / std::sqrt(2.0)) * shading(p);
        const double real = clean + sigma * rng.normal(), imaginary = sigma * rng.normal();
        image.values[static_cast<std::size_t>(image.offset(i, j, k))] =
            static_cast<float>(std::hypot(real, imaginary));
      }
    }
  };
  for (Index begin = 0; begin < image.size[2]; begin += kBatch) {
    monitor.check_cancelled();
    monitor.progress("phantom", static_cast<double>(begin) / image.size[2]);
    parallel_for(std::min(kBatch, image.size[2] - begin), [&](Index n) { draw(begin + n); });
  }
  monitor.progress("phantom", 1.0);
  return image;
}

}  // namespace coxa
