#include <coxa/segment/evolve.h>

#include "level_forces.h"

#include <coxa/collide/surface_contact.h>
#include <coxa/core/error.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/mesh/measures.h>
#include <coxa/segment/force_field.h>

#include <algorithm>
#include <memory>

namespace coxa::segment {
namespace {

/// s. With unit masses and stiffnesses of about one, a step goes nine tenths of the way to
/// equilibrium; the masses bound how far a vertex may go that the forces hardly hold.
constexpr double kTimeStep = 3.0;
/// Relative residual of the linear solve of a step: far below the error of the forces.
constexpr double kLinearTolerance = 1e-4;
/// Passes of local smoothing of the force field after each vertex has chosen.
constexpr int kFieldSmoothing = 2;
/// Penalty of a match at the end of the search range.
constexpr double kShiftPenalty = 0.1;

/// mm. Cartilages are 1 to 3 mm thick: what is deeper inside than this is nearer to the far side.
constexpr double kContactReach = 1.5;
/// Only sides that look at each other push: the far side of a thin sheet does not.
constexpr double kContactFacing = 0.3;

/// Confidence of a good match. The model is fitted with the cubes of the confidences: places that
/// found something else must not outvote what the others say of them.
constexpr double kGoodMatch = 0.7;

/// Share of the iterations in which the front of places that count reaches the last one in view.
constexpr double kGrowing = 0.7;

using Contacts = std::vector<std::unique_ptr<collide::SurfaceContact>>;

/// mm², mean area around a vertex.
double vertex_area(const SimplexMesh& mesh) {
  return area(fan_surface(mesh)) / static_cast<double>(mesh.n_vertices());
}

std::size_t level_of(const Body& body, const Resolution& resolution) {
  const std::size_t finest = body.model->hierarchy.levels.size() - 1;
  return finest - std::min(finest, resolution.coarsening);
}

const shape::ProfileSet& profiles_for(const Body& body, const std::string& contrast) {
  for (const shape::ProfileSet& set : body.model->profiles) {
    const bool alike = body.model->muscle && set.contrast == base_of(contrast);
    if (set.contrast == contrast || alike) return set;
  }
  fail(ErrorCode::bad_input, "the atlas has no '", contrast, "' profiles for ", body.model->name);
}

const ProfileKinds* kinds_for(const Body& body, const std::string& contrast) {
  if (!body.prepared) return nullptr;
  const auto found = body.prepared->kinds.find(body.model->muscle ? base_of(contrast) : contrast);
  return found == body.prepared->kinds.end() ? nullptr : &found->second;
}

/// The displacement the image asks for at the finest vertices, regularised.
Points regularised_field(const Body& body, const Points& normals, const Resolution& resolution) {
  const SimplexHierarchy& hierarchy = body.model->hierarchy;
  const VecX& confidence = body.match.confidence;
  const Points raw = body.match.shift.asDiagonal() * normals;
  const Points local =
      smoothed_field(raw, confidence, hierarchy.levels.back().neighbours, kFieldSmoothing);
  const Points combined =
      combined_levels(local, confidence, hierarchy.maps, resolution.level_share);
  return regularised_by_affine(body.points, combined, confidence, resolution.affine_k);
}

/// Whether boxes about two bodies come near enough for contact in this step.
bool near(const Points& a, const Points& b) {
  const auto low = a.colwise().minCoeff().cwiseMax(b.colwise().minCoeff()).eval();
  const auto high = a.colwise().maxCoeff().cwiseMin(b.colwise().maxCoeff()).eval();
  return ((low - high).array() <= 2.0 * kContactReach).all();
}

/// Contact between all near pairs of bodies and with their obstacles.
Contacts make_contacts(const std::vector<LevelForces>& levels, const Surroundings& surroundings,
                       const SegmentOptions& options) {
  Contacts contacts;
  if (options.weights.contact <= 0.0) return contacts;
  collide::ContactOptions contact;
  contact.minimum_gap = options.minimum_gap;
  contact.search_distance = kContactReach;
  contact.facing = kContactFacing;
  contact.quadrature = collide::ContactQuadrature::vertices;
  for (std::size_t a = 0; a < levels.size(); ++a) {
    // the weight is per vertex, so that a coarse mesh is not pushed harder for its larger triangles
    contact.stiffness = options.weights.contact / vertex_area(levels[a].mesh());
    const auto slave = collide::make_particle_surface(levels[a].mesh(), levels[a].first());
    for (const TriMesh& obstacle : surroundings.obstacles[a]) {
      if (near(levels[a].mesh().points, obstacle.points))
        contacts.push_back(std::make_unique<collide::SurfaceContact>(slave, obstacle, contact));
    }
    for (std::size_t b = 0; b < levels.size(); ++b) {
      if (a == b || !near(levels[a].mesh().points, levels[b].mesh().points)) continue;
      contacts.push_back(std::make_unique<collide::SurfaceContact>(
          slave, collide::make_particle_surface(levels[b].mesh(), levels[b].first()), contact));
    }
  }
  return contacts;
}

/// One backward Euler step from rest; positions are changed in place.
void update_by_step(VecX& x, const std::vector<LevelForces>& levels, Contacts& contacts) {
  std::vector<const dynamics::Force*> forces;
  for (const LevelForces& level : levels) {
    for (const dynamics::Force* force : level.forces()) forces.push_back(force);
  }
  for (const auto& contact : contacts) {
    contact->update_pairs(x);
    forces.push_back(contact.get());
  }
  const Index n = static_cast<Index>(x.size() / 3);
  dynamics::Particles particles{x, VecX::Zero(x.size()), VecX::Ones(n)};
  dynamics::Stepper stepper(n, forces);
  dynamics::StepOptions step;
  step.time_step = kTimeStep;
  step.linear = {.tolerance = kLinearTolerance, .max_iterations = 200};
  stepper.update_step(particles, {}, step);
  x = particles.x;
}

/// Refits the statistical model to where the image pulls the body.
void update_fit(Body& body, const Points& field, const Resolution& resolution) {
  const SmoothModes* smooth = resolution.smooth && body.prepared ? &body.prepared->smooth : nullptr;
  const VecX certain = body.match.confidence.array().cube() / (kGoodMatch * kGoodMatch);
  body.fit = fit_model(*body.model, body.points + field, certain, resolution.model_noise, smooth);
}

/// mm, of the farthest place in view.
double last_reach(const Body& body) {
  return body.reach.size() == 0 ? 0.0 : body.reach.cwiseProduct(body.match.seen).maxCoeff();
}

/// Takes the confidence of what lies beyond the front.
/// @param grown share of the way from the first reach to the last place in view, >= 0
/// @returns whether all counts
bool update_within_front(Body& body, double first_reach, double grown) {
  const double last = last_reach(body);
  if (last <= first_reach || grown >= 1.0) return true;
  const double front = first_reach + grown * (last - first_reach);
  body.match.confidence.array() *= (body.reach.array() <= front).cast<double>();
  return false;
}

}  // namespace

std::string base_of(const std::string& contrast) { return contrast.substr(0, contrast.find('_')); }

ProfileMatch match_body(const Body& body, std::span<const PreparedImage> images,
                        const Resolution& resolution, double gradient_weight) {
  const Points normals = simplex_normals(finest_mesh(body));
  const ProfileSearch search{.range = resolution.range,
                             .window = resolution.window,
                             .gradient_weight = gradient_weight,
                             .shift_penalty = kShiftPenalty,
                             .image_sigma = resolution.image_sigma};
  ProfileScores scores;
  VecX reliability;
  for (const PreparedImage& image : images) {
    const shape::ProfileSet& reference = profiles_for(body, image.contrast);
    ProfileScores more = score_profiles(image, body.points, normals, reference, search,
                                        kinds_for(body, image.contrast));
    if (reliability.size() == 0) {
      scores = std::move(more);
      reliability = reference.reliability;
    } else {
      update_combined(scores, more);
      reliability = reliability.cwiseMax(reference.reliability);
    }
  }
  update_smoothed(scores, body.model->hierarchy.levels.back().neighbours, reliability,
                  resolution.score_smoothing);
  return best_match(scores, reliability);
}

int update_bodies(std::vector<Body>& bodies, const Surroundings& surroundings,
                  const Resolution& resolution, const SegmentOptions& options,
                  const Monitor& monitor) {
  std::vector<LevelForces> levels;
  Index n_particles = 0;
  for (const Body& body : bodies) {
    levels.emplace_back(body, level_of(body, resolution), n_particles);
    n_particles += levels.back().n();
  }
  VecX x(3 * Eigen::Index{n_particles});
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    monitor.check_cancelled();
    monitor.progress("segment", iteration / static_cast<double>(options.iterations));
    bool all_count = true;
    const double grown = iteration / (kGrowing * options.iterations);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      Body& body = bodies[b];
      body.match = match_body(body, surroundings.images, resolution, options.gradient_weight);
      all_count = update_within_front(body, resolution.first_reach, grown) && all_count;
      const Points normals = simplex_normals(finest_mesh(body));
      const Points field = regularised_field(body, normals, resolution);
      update_fit(body, field, resolution);
      if (resolution.fit_only) continue;
      const Points positions = level_points(body.model->hierarchy, level_of(body, resolution),
                                            body.points, body.fit.pose);
      for (Index v = 0; v < levels[b].n(); ++v) {
        x.segment<3>(3 * (levels[b].first() + v)) = positions.row(v).transpose();
      }
      levels[b].prepare(body, positions, field, options.weights, surroundings.hosts[b],
                        options.minimum_gap);
    }
    const VecX start = x;
    if (!resolution.fit_only) {
      Contacts contacts = make_contacts(levels, surroundings, options);
      update_by_step(x, levels, contacts);
    }
    // carry the level's moves to the finest vertices
    double move = 0.0, count = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      Body& body = bodies[b];
      Points change;
      if (resolution.fit_only) {
        change = body.fit.points - body.points;
      } else {
        const Points level_change = Eigen::Map<const Points>(
            VecX(x - start).data() + 3 * Eigen::Index{levels[b].first()}, levels[b].n(), 3);
        change = field_at_finest(body.model->hierarchy, level_of(body, resolution), level_change);
      }
      body.points += change;
      move += change.rowwise().norm().sum();
      count += static_cast<double>(change.rows());
    }
    if (all_count && move / count < options.tolerance) return iteration + 1;
  }
  return options.iterations;
}

}  // namespace coxa::segment
