#include <coxa/pipeline/completed_bones.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/io/head_shape_file.h>
#include <coxa/mesh/mirrored.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/vertex_normals.h>
#include <coxa/pipeline/subject.h>
#include <coxa/segment/model_fit.h>

#include <algorithm>
#include <cmath>

namespace coxa::pipeline {
namespace {

// the atlas' hips are right hips: a left one is mirrored at x = 0 on the way in and out
Vec3 mirrored(const Vec3& p) { return {-p.x(), p.y(), p.z()}; }

/// The part of a bone that is in view, to be found from a model.
class SeenBone {
 public:
  explicit SeenBone(const TriMesh& mesh)
      : tree_(mesh.points, mesh.triangles), normals_(triangle_normals(mesh)) {
    at_border_.assign(static_cast<std::size_t>(mesh.n_vertices()), false);
    const MeshEdges edges = mesh_edges(mesh);
    for (Index e = 0; e < edges.triangles.size(); ++e) {
      if (edges.triangles[e].size() > 1) continue;
      for (int end = 0; end < 2; ++end)
        at_border_[static_cast<std::size_t>(edges.vertices(e, end))] = true;
    }
  }

  /// The point of the bone that belongs to a vertex of the model; NaN where there is none.
  Vec3 match(const Vec3& p, const Vec3& normal, double limit) const {
    constexpr double kAlike = 0.6;  // cosine between normals
    const auto nearest = tree_.nearest_within(p, limit);
    if (!nearest) return Vec3::Constant(kNaN);
    if (normals_.row(nearest->triangle).dot(normal) < kAlike) return Vec3::Constant(kNaN);
    for (int corner = 0; corner < 3; ++corner) {
      const Index v = tree_.triangles()(nearest->triangle, corner);
      if (at_border_[static_cast<std::size_t>(v)]) return Vec3::Constant(kNaN);
    }
    return nearest->point;
  }

 private:
  TriangleTree tree_;
  Points normals_;
  std::vector<bool> at_border_;
};

struct Matches {
  Points targets;
  VecX weights;
};

Matches matches_of(const SeenBone& bone, const SimplexMesh& model, double limit) {
  const Points normals = simplex_normals(model);
  Matches matches{model.points, VecX::Zero(model.n_vertices())};
  parallel_for(model.n_vertices(), [&](Index v) {
    const Vec3 found = bone.match(model.points.row(v), normals.row(v), limit);
    if (!found.allFinite()) return;
    matches.targets.row(v) = found;
    matches.weights[v] = 1.0;
  });
  return matches;
}

CompletedBone complete_right_bone(const TriMesh& seen, const shape::StructureModel& model,
                                  const Vec3& head_centre) {
  constexpr int kRounds = 30;
  constexpr double kFirstLimit = 20.0, kLastLimit = 4.0, kShrink = 0.88;  // mm
  constexpr double kNoise = 1.0;                                          // mm
  constexpr double kFewest = 0.1;
  constexpr double kStill = 0.05;  // mm
  const SeenBone bone(seen);
  SimplexMesh shape = model.hierarchy.levels.back();
  shape.points.rowwise() += head_centre.transpose();
  segment::ModelFit fit;
  Matches matches;
  for (int round = 0; round < kRounds; ++round) {
    const double limit = std::max(kLastLimit, kFirstLimit * std::pow(kShrink, round));
    matches = matches_of(bone, shape, limit);
    require(matches.weights.mean() >= kFewest, "the shape model of the ", model.name,
            " does not find the bone in view");
    fit = segment::fit_model(model, matches.targets, matches.weights, kNoise);
    const double moved = (fit.points - shape.points).rowwise().norm().maxCoeff();
    shape.points = fit.points;
    if (limit == kLastLimit && moved < kStill) break;
  }
  CompletedBone completed;
  completed.surface = dual_surface(shape);
  for (const auto& [name, vertex] : model.landmark_vertices)
    completed.landmarks[name] = shape.points.row(vertex);
  completed.leftward = fit.pose.X.R.col(0);
  const VecX off = (shape.points - matches.targets).rowwise().squaredNorm();
  completed.residual = std::sqrt(off.dot(matches.weights) / matches.weights.sum());
  completed.in_view = matches.weights.mean();
  return completed;
}

bool has(const motion::FrameLandmarks& landmarks, const std::string& name, Side side) {
  const char* suffix = side == Side::right ? "_right" : "_left";
  return landmarks.points.contains(name + suffix) || landmarks.points.contains(name);
}

// enough landmarks for the pelvis frame by ISB
bool pelvis_is_known(const motion::FrameLandmarks& landmarks) {
  const auto& points = landmarks.points;
  return points.contains("asis_right") && points.contains("asis_left") &&
         (points.contains("psis_right") || points.contains("psis_left"));
}

const TriMesh* find_mesh(const SurfaceSet& surfaces, const char* name) {
  const auto it = surfaces.find(name);
  return it == surfaces.end() || it->second.mesh.empty() ? nullptr : &it->second.mesh;
}

}  // namespace

motion::JointCentreOptions joint_centre_options(Side side) {
  return {.head_prior =
              motion::HeadPrior{io::read_head_shape(shipped_data("femoral_head.toml")), side}};
}

CompletedBone complete_bone(const TriMesh& seen, const shape::StructureModel& model,
                            const Vec3& head_centre, Side side) {
  if (side == Side::right) return complete_right_bone(seen, model, head_centre);
  CompletedBone completed = complete_right_bone(mirrored(seen), model, mirrored(head_centre));
  completed.surface = mirrored(completed.surface);
  for (auto& [name, p] : completed.landmarks) p = mirrored(p);
  completed.leftward = -mirrored(completed.leftward);
  return completed;
}

motion::FrameLandmarks completed_pelvis_landmarks(const CompletedBone& hip_bone, Side side) {
  const Vec3 n = hip_bone.leftward;
  const double sign = side == Side::right ? 1.0 : -1.0;
  // the median plane touches the bone at the symphysis
  const double middle = sign * (sign * (hip_bone.surface.points * n)).maxCoeff();
  motion::FrameLandmarks completed{{}, "shape model completion", kCompletedLandmarkSd};
  for (const std::string name : {"asis", "psis"}) {
    const auto it = hip_bone.landmarks.find(name);
    require(it != hip_bone.landmarks.end(), "the atlas does not know the landmark ", name);
    const Vec3 other = it->second - 2.0 * (it->second.dot(n) - middle) * n;
    completed.points[name + (side == Side::right ? "_right" : "_left")] = it->second;
    completed.points[name + (side == Side::right ? "_left" : "_right")] = other;
  }
  return completed;
}

motion::BoneFrames make_completed_frames(const SurfaceSet& surfaces,
                                         const motion::FrameLandmarks& landmarks,
                                         const shape::Atlas& atlas, const Vec3& joint_centre,
                                         Side side, const motion::BoneFrameOptions& options) {
  std::vector<std::string> warnings;
  const auto completed = [&](const char* name) -> std::optional<CompletedBone> {
    const TriMesh* seen = find_mesh(surfaces, name);
    if (!seen) return std::nullopt;
    try {
      return complete_bone(*seen, shape::structure(atlas, name), joint_centre, side);
    } catch (const Error& error) {
      warnings.push_back(std::string(name) + " is not completed: " + error.what());
      return std::nullopt;
    }
  };
  SurfaceSet whole = surfaces;
  bool femur_is_completed = false;
  const TriMesh* femur_seen = find_mesh(surfaces, "femur");
  const bool knee_is_known =
      (has(landmarks, "medial_epicondyle", side) && has(landmarks, "lateral_epicondyle", side)) ||
      (femur_seen && motion::find_epicondyles(*femur_seen, joint_centre, side));
  if (!knee_is_known) {
    if (const auto femur = completed("femur")) {
      whole["femur"].mesh = femur->surface;
      femur_is_completed = true;
    }
  }
  motion::BoneFrames frames =
      motion::make_bone_frames(whole, landmarks, joint_centre, side, options);
  if (femur_is_completed) frames.femur.source = "shape model completion, " + frames.femur.source;
  if (!pelvis_is_known(landmarks)) {
    if (const auto bone = completed("hip_bone")) {
      motion::FrameLandmarks found = completed_pelvis_landmarks(*bone, side);
      for (auto& [name, p] : found.points) {
        const auto given = frames.landmarks.find(name);
        if (given == frames.landmarks.end()) continue;
        p = given->second;
        found.source = "landmarks and shape model completion";
      }
      frames.pelvis = motion::make_bone_frames({}, found, joint_centre, side).pelvis;
      for (const auto& [name, p] : found.points) frames.landmarks[name] = p;
    }
  }
  frames.warnings.insert(frames.warnings.end(), warnings.begin(), warnings.end());
  return frames;
}

}  // namespace coxa::pipeline
