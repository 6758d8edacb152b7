#include "pose_fit.h"

#include <coxa/segment/evolve.h>

#include <algorithm>
#include <cmath>

#include "pose_score.h"

namespace coxa::segment {
namespace {

/// Of the mean correlation, for one standard deviation off the mean, squared.
constexpr double kCost = 0.01;
/// Standard deviations: of the logarithm of size; of where two bones have the joint's centre, mm
/// (bones fitted to the right place had it 1 to 5 mm apart, to wrong ones 2 to 16); and of the turn
/// from the atlas' orientation, rad (a real hip is turned by 0.4, most simulated ones by less than
/// 0.2, and wrong places by up to 0.6).
constexpr double kSizeSpread = 0.07, kJointSpread = 4.0, kTurnSpread = 0.25;
/// Of a fit; the models follow within a few.
constexpr int kIterations = 8;

/// mm, largest distance between where two of the bones have the joint's centre.
double dislocation(const std::vector<Body>& bodies) {
  double largest = 0.0;
  for (const Body& a : bodies)
    for (const Body& b : bodies)
      largest = std::max(largest, (a.fit.pose.X.p - b.fit.pose.X.p).norm());
  return largest;
}

double score_of(const std::vector<Body>& bodies) {
  double sum = 0.0, weight = 0.0, all = 0.0;
  double cost = kCost * std::pow(dislocation(bodies) / kJointSpread, 2);
  for (const Body& body : bodies) {
    cost += (size_cost(body.fit.pose.scale) + turn_cost(body.fit.pose.X.R)) /
            static_cast<double>(bodies.size());
    sum += body.match.here.sum();
    weight += body.match.seen.sum();
    all += static_cast<double>(body.match.seen.size());
  }
  return sum / std::max(weight, kShareInView * all) - cost;
}

}  // namespace

double size_cost(double scale) { return kCost * std::pow(std::log(scale) / kSizeSpread, 2); }

double turn_cost(const Mat3& R) {
  const double angle = std::acos(std::clamp(0.5 * (R.trace() - 1.0), -1.0, 1.0));
  return kCost * std::pow(angle / kTurnSpread, 2);
}

Vec3 joint_centre(const PlacedBones& place) {
  Vec3 sum = Vec3::Zero();
  for (const Body& body : place.bodies) sum += body.fit.pose.X.p;
  return sum / static_cast<double>(place.bodies.size());
}

PlacedBones placed_bones(const std::vector<const shape::StructureModel*>& bones,
                         const Similarity& pose, const std::string& contrast) {
  PlacedBones place{{}, contrast};
  for (const shape::StructureModel* bone : bones) {
    Body body;
    body.model = bone;
    body.points = posed(bone->hierarchy.levels.back().points, pose);
    body.fit = {body.points, pose, VecX::Zero(bone->shape.deviations.size()), 0.0};
    place.bodies.push_back(std::move(body));
  }
  return place;
}

void update_placed(PlacedBones& place, PreparedImage image, const PlaceFit& fit,
                   const SegmentOptions& options) {
  image.contrast = place.contrast;
  const Resolution resolution{.coarsening = 3,
                              .range = fit.range,
                              .image_sigma = fit.sigma,
                              .window = fit.window,
                              .score_smoothing = 12,
                              .model_noise = 3.0,
                              .fit_only = true};
  const std::vector<Obstacles> none(place.bodies.size());
  const std::vector<TriMesh> no_host(place.bodies.size());
  SegmentOptions few = options;
  few.iterations = std::min(options.iterations, kIterations);
  update_bodies(place.bodies, {{&image, 1}, none, no_host}, resolution, few, {});
  place.score = score_of(place.bodies);
}

}  // namespace coxa::segment
