#include <coxa/segment/segment.h>

#include "result.h"
#include "schedule.h"

#include <coxa/core/error.h>
#include <coxa/segment/evolve.h>
#include <coxa/segment/lay_on_hosts.h>
#include <coxa/segment/layer_extent.h>
#include <coxa/segment/layer_search.h>
#include <coxa/segment/placement.h>
#include <coxa/segment/pose_search.h>
#include <coxa/segment/seat.h>

#include <algorithm>
#include <set>
#include <span>

namespace coxa::segment {
namespace {

void check(const SegmentOptions& options) {
  require(!options.structures.empty(), "no structure is asked for");
  require(options.landmark_error >= 0.0, "landmark_error must be at least 0 mm, got ",
          options.landmark_error);
  require(options.search_range > 0.0, "search_range must be positive, got ", options.search_range,
          " mm");
  require(options.gradient_weight >= 0.0, "gradient_weight must be at least 0, got ",
          options.gradient_weight);
  require(options.minimum_gap >= 0.0, "minimum_gap must be at least 0 mm, got ",
          options.minimum_gap);
  require(options.iterations >= 1, "iterations must be at least 1, got ", options.iterations);
  require(options.tolerance >= 0.0, "tolerance must be at least 0 mm, got ", options.tolerance);
  require(options.minimum_quality >= 0.0 && options.minimum_quality <= 1.0,
          "minimum_quality must be in [0, 1], got ", options.minimum_quality);
  const ForceWeights& w = options.weights;
  require(std::min({w.image, w.shape, w.smoothing, w.memory, w.contact}) >= 0.0,
          "the force weights must be at least 0");
}

std::vector<PreparedImage> smoothed_images(const std::vector<PreparedImage>& images, double sigma) {
  std::vector<PreparedImage> out = images;
  if (sigma <= 0.0) return out;
  for (PreparedImage& image : out) image.volume = smoothed(image.volume, sigma);
  return out;
}

void update_through(std::vector<Body>& bodies, const std::vector<Resolution>& resolutions,
                    const std::vector<PreparedImage>& images,
                    const std::vector<Obstacles>& obstacles, const std::vector<TriMesh>& hosts,
                    const SegmentOptions& options, const Monitor& monitor) {
  for (std::size_t r = 0; r < resolutions.size(); ++r) {
    const auto smooth = smoothed_images(images, resolutions[r].image_sigma);
    const double share = 1.0 / static_cast<double>(resolutions.size());
    const double from = static_cast<double>(r) * share;
    update_bodies(bodies, {smooth, obstacles, hosts}, resolutions[r], options,
                  part_of(monitor, "segment", from, from + share));
  }
}

/// "t1" of "t1_fluid": what the bones show; whether fluid parts the cartilages only these show.
std::string base_of(const std::string& contrast) { return contrast.substr(0, contrast.find('_')); }

/// The contrast whose profiles, after placing the bodies with them, fit this
/// image best, beside the images whose contrast is known already: a second
/// image with half the hip cannot mislead what the first one shows. Where the image has one
/// already, only that one and its variants are tried.
std::string best_contrast(const std::vector<Body>& bodies, std::span<const PreparedImage> known,
                          const PreparedImage& image, const Resolution& resolution,
                          const SegmentOptions& options) {
  if (options.contrast) return *options.contrast;
  std::set<std::string> contrasts;
  for (const shape::ProfileSet& set : bodies.front().model->profiles) {
    if (base_of(set.contrast) == base_of(image.contrast) || image.contrast.empty())
      contrasts.insert(set.contrast);
  }
  require(!contrasts.empty(), "the atlas has no intensity profiles");
  std::vector<PreparedImage> images(known.begin(), known.end());
  images.push_back(image);
  images = smoothed_images(images, resolution.image_sigma);
  std::string best;
  double best_fit = -kInfinity;
  SegmentOptions few = options;
  few.iterations = std::min(options.iterations, 6);
  for (const std::string& contrast : contrasts) {
    images.back().contrast = contrast;
    std::vector<Body> trial = bodies;
    const std::vector<Obstacles> none(trial.size());
    const std::vector<TriMesh> no_host(trial.size());
    update_bodies(trial, {images, none, no_host}, resolution, few, {});
    double fit = 0.0;
    for (const Body& body : trial) fit += body.match.here.mean();
    if (fit > best_fit) {
      best_fit = fit;
      best = contrast;
    }
  }
  return best;
}

Body placed_body(const shape::StructureModel& model, Points placed) {
  Body body;
  body.model = &model;
  body.fit = fit_model(model, placed, VecX::Ones(placed.rows()), 1.0);
  body.points = body.fit.points;
  return body;
}

/// Lengths over which the unknown deformations of a bone are alike, mm, and how large they are
/// beside what the examples leave of each other.
constexpr double kLongLength = 60.0, kLongShare = 3.0;
constexpr double kShortLength = 25.0, kShortShare = 1.0;

/// What the examples do not show of a structure.
Preparation prepared(const shape::StructureModel& model) {
  const SimplexMesh& mesh = model.hierarchy.levels.back();
  Preparation preparation;
  for (const shape::ProfileSet& set : model.profiles)
    preparation.kinds[set.contrast] = profile_kinds(set, mesh.neighbours);
  const double left = std::isnan(model.leave_one_out_error) ? 0.0 : model.leave_one_out_error;
  preparation.smooth =
      joined(smooth_modes(mesh.points, {.deviation = kLongShare * left, .length = kLongLength}),
             smooth_modes(mesh.points, {.deviation = kShortShare * left, .length = kShortLength}));
  return preparation;
}

/// Landmarks placed on slices are as exact as these are thin: borders are looked for at least this
/// many voxels away.
constexpr double kVoxelsSearched = 3.0;

/// mm, for the image with the thinnest slices.
double range_of_search(const std::vector<PreparedImage>& images, const SegmentOptions& options) {
  double thinnest = kInfinity;
  for (const PreparedImage& image : images)
    thinnest = std::min(thinnest, image.volume.spacing.maxCoeff());
  return std::max(options.search_range, kVoxelsSearched * thinnest);
}

/// A structure's confidence below which the caller is warned; a good fit has 0.6 to 0.9.
constexpr double kLowConfidence = 0.4;
/// A bone's confidence below which it is looked for once more, in a narrower search (share of the
/// usual range).
constexpr double kDoubtfulBone = 0.6, kNarrowShare = 2.0 / 3.0;
/// A quality below which the whole hip is doubtful; adults in fair images have 0.55 to 0.7.
constexpr double kDoubtfulQuality = 0.5;

/// Keeps of every bone the better found.
void update_best(std::vector<Body>& best, std::vector<Body> others) {
  for (std::size_t b = 0; b < best.size(); ++b) {
    if (quality_of(others[b]).confidence > quality_of(best[b]).confidence)
      best[b] = std::move(others[b]);
  }
}

bool any_doubtful(const std::vector<Body>& bodies) {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& body) { return quality_of(body).confidence < kDoubtfulBone; });
}

/// Everything about one hip, as a right hip.
class Hip {
 public:
  Hip(std::vector<PreparedImage> images, const shape::Atlas& atlas, const SegmentOptions& options)
      : images_(std::move(images)), atlas_(atlas), options_(options) {
    choose_models();
    for (std::size_t s = 0; s < models_.size(); ++s)
      preparations_.push_back(hosts_[s] ? Preparation{} : prepared(*models_[s]));
    bodies_.resize(models_.size());
  }

  void segment_bones(const shape::Landmarks& landmarks, const Monitor& monitor) {
    std::vector<std::size_t> numbers;
    std::vector<const shape::StructureModel*> models;
    for (std::size_t s = 0; s < models_.size(); ++s) {
      if (hosts_[s]) continue;
      numbers.push_back(s);
      models.push_back(models_[s]);
    }
    std::vector<Body> bones;
    const std::vector<Points> placed =
        landmarks.empty() ? find_pose(models, images_, options_, monitor).placed
                          : place_by_landmarks(models, landmarks, atlas_, options_.landmark_error);
    for (std::size_t b = 0; b < models.size(); ++b) {
      bones.push_back(placed_body(*models[b], placed[b]));
      bones.back().prepared = &preparations_[numbers[b]];
    }
    const double wide = range_of_search(images_, options_);
    choose_contrasts(bones, bone_resolutions(wide).front());
    std::vector<Body> best = found_within(wide, bones, part_of(monitor, "segment", 0.0, 0.5));
    // too wide a search may take another border for the bone's
    if (wide > options_.search_range)
      update_best(
          best, found_within(options_.search_range, bones, part_of(monitor, "segment", 0.5, 0.75)));
    if (any_doubtful(best))
      update_best(best, found_within(kNarrowShare * options_.search_range, bones,
                                     part_of(monitor, "segment", 0.75, 1.0)));
    for (std::size_t b = 0; b < bones.size(); ++b) bodies_[numbers[b]] = std::move(best[b]);
  }

  void segment_layers(const Monitor& monitor) {
    std::vector<std::size_t> numbers;
    std::vector<Body> layers;
    std::vector<TriMesh> means, seats;
    for (std::size_t s = 0; s < models_.size(); ++s) {
      if (!hosts_[s]) continue;
      const Body& host = bodies_[*hosts_[s]];
      means.push_back(dual_surface(host.model->hierarchy.levels.back()));
      seats.push_back(surface_mesh(host));
      Body layer = placed_body(
          *models_[s],
          carried_points(models_[s]->hierarchy.levels.back().points, means.back(), seats.back()));
      layer.seat = seated_vertices(*models_[s], means.back());
      numbers.push_back(s);
      layers.push_back(std::move(layer));
    }
    if (layers.empty()) return;
    const auto resolutions = layer_resolutions();
    choose_contrasts(layers, resolutions.front());
    place_layers(layers, means, seats, resolutions.front());
    // no layer enters any bone
    Obstacles bones;
    for (std::size_t s = 0; s < models_.size(); ++s) {
      if (!hosts_[s]) bones.push_back(surface_mesh(bodies_[s]));
    }
    update_through(layers, resolutions, images_, std::vector<Obstacles>(layers.size(), bones),
                   seats, options_, monitor);
    for (std::size_t b = 0; b < layers.size(); ++b) bodies_[numbers[b]] = std::move(layers[b]);
  }

  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<PreparedImage>& images() const { return images_; }
  bool is_bone(std::size_t s) const { return !hosts_[s].has_value(); }

  /// The surfaces of all bodies: layers with the extent that the images show, on their bones.
  std::vector<Surface> surfaces(std::vector<std::string>& warnings) const {
    std::vector<Surface> surfaces;
    for (const Body& body : bodies_) surfaces.push_back(surface_of(body));
    std::vector<ExtentLayer> sided;
    std::vector<std::string> names;
    std::vector<LaidLayer> layers;
    for (std::size_t s = 0; s < bodies_.size(); ++s) {
      if (!hosts_[s]) continue;
      TriMesh *layer = &surfaces[s].mesh, *host = &surfaces[*hosts_[s]].mesh;
      layers.push_back({layer, host});
      if (models_[s]->n_bone_side == 0) continue;
      sided.push_back({layer, host, models_[s]->n_bone_side});
      names.push_back(models_[s]->name);
    }
    const std::vector<double> separations = update_extents(sided, images_);
    for (std::size_t l = 0; l < sided.size(); ++l) {
      if (separations[l] >= kTellsApart) continue;
      warnings.push_back(join_text(
          "the rims and thickness of the ", names[l], " are the atlas's: the image tells only ",
          std::lround(100.0 * separations[l]), " % of covered and bare bone apart"));
    }
    lay_on_hosts(layers, options_.minimum_gap);
    return surfaces;
  }

  /// Whether the caller asked for it, or only something that lies on it needs it.
  bool is_asked_for(std::size_t s) const {
    const auto& names = options_.structures;
    return std::find(names.begin(), names.end(), models_[s]->name) != names.end();
  }

 private:
  void choose_contrasts(const std::vector<Body>& bodies, Resolution resolution) {
    resolution.fit_only = true;
    for (std::size_t i = 0; i < images_.size(); ++i) {
      images_[i].contrast =
          best_contrast(bodies, std::span(images_).first(i), images_[i], resolution, options_);
    }
  }

  std::vector<Body> found_within(double range, std::vector<Body> bones,
                                 const Monitor& monitor) const {
    update_through(bones, bone_resolutions(range), images_, std::vector<Obstacles>(bones.size()),
                   std::vector<TriMesh>(bones.size()), options_, monitor);
    return bones;
  }

  /// Layers with sides known start with the modes that fit the images best.
  void place_layers(std::vector<Body>& layers, const std::vector<TriMesh>& means,
                    const std::vector<TriMesh>& seats, Resolution resolution) {
    resolution.range = 0.0;
    resolution.score_smoothing = 0;
    const auto smooth = smoothed_images(images_, resolution.image_sigma);
    for (std::size_t b = 0; b < layers.size(); ++b) {
      if (layers[b].model->n_bone_side == 0) continue;
      const VecX seat = layers[b].seat;
      const Points placed =
          layer_by_modes(layers[b], means[b], seats[b], smooth, resolution, options_);
      layers[b] = placed_body(*layers[b].model, placed);
      layers[b].points = placed;
      layers[b].seat = seat;
    }
  }

  /// The structures asked for and the ones they lie on.
  void choose_models() {
    std::vector<const shape::StructureModel*> all;
    for (const shape::StructureModel& model : atlas_.structures) all.push_back(&model);
    const auto hosts = find_hosts(all);
    std::set<std::string> wanted;
    for (const std::string& name : options_.structures) {
      wanted.insert(shape::structure(atlas_, name).name);
    }
    for (std::size_t s = 0; s < all.size(); ++s) {
      if (wanted.contains(all[s]->name) && hosts[s]) wanted.insert(all[*hosts[s]]->name);
    }
    for (const shape::StructureModel* model : all) {
      if (wanted.contains(model->name)) models_.push_back(model);
    }
    hosts_ = find_hosts(models_);
  }

  std::vector<PreparedImage> images_;
  const shape::Atlas& atlas_;
  const SegmentOptions& options_;
  std::vector<const shape::StructureModel*> models_;
  std::vector<std::optional<std::size_t>> hosts_;
  std::vector<Preparation> preparations_;
  std::vector<Body> bodies_;
};

/// From each landmark to the atlas' own, at the pose of the bone that brings it nearest.
std::map<std::string, double> landmark_distances(const Hip& hip, const shape::Atlas& atlas,
                                                 const shape::Landmarks& landmarks) {
  std::map<std::string, double> distances;
  for (const auto& [name, place] : landmarks) {
    double nearest = kInfinity;
    for (std::size_t s = 0; s < hip.bodies().size(); ++s) {
      if (!hip.is_bone(s)) continue;
      const Similarity& pose = hip.bodies()[s].fit.pose;
      const Vec3 own = pose.X * (pose.scale * atlas.landmarks.at(name));
      nearest = std::min(nearest, (own - place).norm());
    }
    distances[name] = nearest;
  }
  return distances;
}

SegmentResult make_result(const Hip& hip, Side side, const SegmentOptions& options) {
  SegmentResult result;
  double bone_confidence = 0.0, n_bones = 0.0;
  const std::vector<Surface> surfaces = hip.surfaces(result.warnings);
  for (std::size_t s = 0; s < hip.bodies().size(); ++s) {
    const Body& body = hip.bodies()[s];
    const StructureQuality quality = quality_of(body);
    result.structures[body.model->name] = quality;
    if (hip.is_bone(s)) {
      bone_confidence += quality.confidence;
      n_bones += 1.0;
    }
    if (!hip.is_asked_for(s)) continue;
    if (quality.confidence < kLowConfidence) {
      result.warnings.push_back(
          join_text(body.model->name, " was found with low confidence, ", quality.confidence));
    }
    const Surface& surface = surfaces[s];
    result.surfaces[body.model->name] = side == Side::left ? mirrored(surface) : surface;
    if (quality.in_view < 0.5) {
      result.warnings.push_back(join_text("only ", std::lround(100.0 * quality.in_view), " % of ",
                                          body.model->name,
                                          " is in view; the rest is the shape model's"));
    }
  }
  result.quality = n_bones > 0.0 ? bone_confidence / n_bones : 1.0;
  if (result.quality < kDoubtfulQuality) {
    result.warnings.push_back(join_text(
        "low confidence: quality ", result.quality, ", below ", kDoubtfulQuality,
        "; the hip may lie outside the atlas, which is made of adults without prostheses"));
  }
  for (const PreparedImage& image : hip.images()) result.contrasts.push_back(image.contrast);
  if (result.quality < options.minimum_quality) {
    fail(ErrorCode::below_quality, "the hip was not found: quality ", result.quality,
         " is below the least allowed, ", options.minimum_quality,
         "; check side, landmarks and that the hip is in the image");
  }
  return result;
}

}  // namespace

SegmentResult segment(const std::vector<Volume>& volumes, const shape::Atlas& atlas, Side side,
                      const shape::Landmarks& landmarks, const SegmentOptions& options,
                      const Monitor& monitor) {
  check(options);
  require(!volumes.empty(), "there is no image to segment");
  std::vector<PreparedImage> images;
  for (const Volume& volume : volumes) {
    images.push_back(
        prepare_image(side == Side::left ? mirrored(volume) : volume, options.correct_bias));
  }
  shape::Landmarks ours = landmarks_of_side(landmarks, atlas, side);
  if (side == Side::left) ours = mirrored(ours);
  Hip hip(std::move(images), atlas, options);
  hip.segment_bones(ours, part_of(monitor, "segment bones", 0.0, 0.7));
  hip.segment_layers(part_of(monitor, "segment cartilages", 0.7, 1.0));
  SegmentResult result = make_result(hip, side, options);
  result.landmark_distances = landmark_distances(hip, atlas, ours);
  return result;
}

}  // namespace coxa::segment
