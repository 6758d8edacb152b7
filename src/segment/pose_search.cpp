#include <coxa/segment/pose_search.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/segment/body.h>
#include <coxa/segment/evolve.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace coxa::segment {
namespace {

/// mm. Image and references are smoothed so far that a grid of this spacing misses nothing.
constexpr double kGrid = 10.0;
constexpr double kSmoothing = 3.0;
/// Vertices per bone that are compared at each place: enough to tell a hip, few enough to try
/// thousands.
constexpr Index kProbes = 80;
/// Share of the probes that must be in view for a place to count in full.
constexpr double kShareInView = 0.5;
/// Places that are refined, and how far apart they are, mm.
constexpr std::size_t kRefined = 8;
constexpr double kApart = 18.0;
/// mm. How far off a place of the grid, and the borders there, may be.
constexpr double kRefinedRange = 12.0;
/// rad. Patients lie on the table within about this of the atlas' orientation.
constexpr double kTurn = 0.26;

struct Candidate {
  RigidTransform pose;
  std::string contrast;
  double score = -kInfinity;
};

/// A few well-spread vertices of a bone with their reference profiles.
struct Probes {
  Points points, normals;
  std::map<std::string, shape::ProfileSet> profiles;
};

Probes probes_of(const shape::StructureModel& bone) {
  const SimplexMesh& mesh = bone.hierarchy.levels.back();
  const Points normals = simplex_normals(mesh);
  const Index V = mesh.n_vertices(), stride = std::max<Index>(1, V / kProbes);
  const Index n = (V + stride - 1) / stride;
  Probes probes{Points(n, 3), Points(n, 3), {}};
  for (const shape::ProfileSet& all : bone.profiles) {
    shape::ProfileSet few = all;
    few.mean.resize(n, all.mean.cols());
    few.reliability.resize(n);
    for (Index i = 0; i < n; ++i) {
      probes.points.row(i) = mesh.points.row(i * stride);
      probes.normals.row(i) = normals.row(i * stride);
      few.mean.row(i) = all.mean.row(i * stride);
      few.reliability[i] = all.reliability[i * stride];
    }
    probes.profiles[all.contrast] = few;
  }
  return probes;
}

/// Mean correlation of the probes at a pose; places mostly out of view count less.
double score_at(const std::vector<Probes>& bones, const PreparedImage& image,
                const Candidate& candidate) {
  const ProfileSearch search{.range = 0.0,
                             .window = 5.0,
                             .gradient_weight = 0.3,
                             .shift_penalty = 0.0,
                             .image_sigma = kSmoothing};
  double sum = 0.0, weight = 0.0, all = 0.0;
  for (const Probes& bone : bones) {
    const auto found = bone.profiles.find(candidate.contrast);
    if (found == bone.profiles.end()) continue;
    const ProfileScores scores =
        score_profiles(image, transformed(bone.points, candidate.pose),
                       bone.normals * candidate.pose.R.transpose(), found->second, search);
    for (Index v = 0; v < scores.score.rows(); ++v) {
      const double w = found->second.reliability[v];
      all += w;
      if (std::isnan(scores.score(v, 0))) continue;
      sum += w * scores.score(v, 0);
      weight += w;
    }
  }
  return all > 0.0 ? sum / std::max(weight, kShareInView * all) : -kInfinity;
}

std::vector<Mat3> orientations() {
  std::vector<Mat3> turns = {Mat3::Identity()};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double angle : {-kTurn, kTurn}) {
      turns.push_back(rotation_from_vector(angle * Vec3::Unit(axis)));
    }
  }
  return turns;
}

std::vector<Candidate> all_candidates(const std::vector<Probes>& bones, const Volume& volume) {
  std::set<std::string> contrasts;
  for (const auto& [name, set] : bones.front().profiles) contrasts.insert(name);
  const std::vector<Mat3> turns = orientations();
  std::vector<Candidate> candidates;
  Vec3 extent;
  for (int a = 0; a < 3; ++a) {
    extent[a] = (volume.size[static_cast<std::size_t>(a)] - 1) * volume.spacing[a];
  }
  // the joint's centre lies in the image
  for (double z = 0.5 * kGrid; z < extent.z(); z += kGrid)
    for (double y = 0.5 * kGrid; y < extent.y(); y += kGrid)
      for (double x = 0.5 * kGrid; x < extent.x(); x += kGrid) {
        const Vec3 p = volume.origin + volume.direction * Vec3(x, y, z);
        for (const Mat3& R : turns)
          for (const std::string& contrast : contrasts)
            candidates.push_back({{R, p}, contrast, -kInfinity});
      }
  return candidates;
}

/// The best-scoring candidates that are apart from each other, best first.
std::vector<Candidate> best_apart(std::vector<Candidate> candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<Candidate> kept;
  for (const Candidate& candidate : candidates) {
    const bool near = std::any_of(kept.begin(), kept.end(), [&](const Candidate& k) {
      return (k.pose.p - candidate.pose.p).norm() < kApart && k.contrast == candidate.contrast;
    });
    if (!near) kept.push_back(candidate);
    if (kept.size() == kRefined) break;
  }
  return kept;
}

/// Bodies at the candidate's pose, fitted to the image.
std::vector<Body> refined(const Candidate& candidate,
                          const std::vector<const shape::StructureModel*>& bones,
                          PreparedImage image, const SegmentOptions& options) {
  std::vector<Body> bodies;
  for (const shape::StructureModel* bone : bones) {
    Body body;
    body.model = bone;
    body.points = transformed(bone->hierarchy.levels.back().points, candidate.pose);
    body.fit = {body.points, {1.0, candidate.pose}, VecX::Zero(bone->shape.deviations.size()), 0.0};
    bodies.push_back(std::move(body));
  }
  image.contrast = candidate.contrast;
  const Resolution resolution{.coarsening = 3,
                              .range = kRefinedRange,
                              .image_sigma = kSmoothing,
                              .window = 5.0,
                              .score_smoothing = 12,
                              .model_noise = 3.0,
                              .fit_only = true};
  const std::vector<Obstacles> none(bodies.size());
  const std::vector<TriMesh> no_host(bodies.size());
  SegmentOptions few = options;
  few.iterations = std::min(options.iterations, 8);
  update_bodies(bodies, {{&image, 1}, none, no_host}, resolution, few, {});
  return bodies;
}

double fit_score(const std::vector<Body>& bodies) {
  double sum = 0.0, weight = 0.0, all = 0.0;
  for (const Body& body : bodies) {
    sum += body.match.here.sum();
    weight += body.match.seen.sum();
    all += static_cast<double>(body.match.seen.size());
  }
  return sum / std::max(weight, kShareInView * all);
}

Vec3 centre_of(const std::vector<Body>& bodies) {
  Vec3 sum = Vec3::Zero();
  for (const Body& body : bodies) sum += body.fit.pose.X.p;
  return sum / static_cast<double>(bodies.size());
}

}  // namespace

FoundPose find_pose(const std::vector<const shape::StructureModel*>& bones,
                    const std::vector<PreparedImage>& images, const SegmentOptions& options,
                    const Monitor& monitor) {
  PreparedImage image = images.front();
  image.volume = smoothed(image.volume, kSmoothing);
  std::vector<Probes> probes;
  for (const shape::StructureModel* bone : bones) probes.push_back(probes_of(*bone));
  std::vector<Candidate> candidates = all_candidates(probes, image.volume);
  require(!candidates.empty(), "the image is too small to look for a hip in");
  parallel_for(static_cast<std::int64_t>(candidates.size()), [&](Index i) {
    if (monitor.cancelled()) return;  // a large image has hundreds of thousands
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    candidate.score = score_at(probes, image, candidate);
  });
  monitor.check_cancelled();

  FoundPose found;
  found.score = -kInfinity;
  Vec3 centre = Vec3::Zero();
  std::vector<std::pair<Vec3, double>> results;
  for (const Candidate& candidate : best_apart(std::move(candidates))) {
    monitor.check_cancelled();
    const std::vector<Body> bodies = refined(candidate, bones, image, options);
    const double score = fit_score(bodies);
    results.emplace_back(centre_of(bodies), score);
    if (score <= found.score) continue;
    found.score = score;
    centre = results.back().first;
    found.placed.clear();
    for (const Body& body : bodies) found.placed.push_back(body.fit.points);
  }
  double rival = -1.0;
  for (const auto& [place, score] : results) {
    if ((place - centre).norm() > kApart) rival = std::max(rival, score);
  }
  found.margin = found.score - rival;
  return found;
}

}  // namespace coxa::segment
