#include <coxa/shape/registration.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/vertex_normals.h>

#include <Eigen/Geometry>
#include <cmath>

namespace coxa::shape {
namespace {

// at most so many places carry the displacement field of a wide Gaussian
constexpr Index kMostCentres = 1500;
// the last projection moves a vertex no farther than this, mm
constexpr double kProjectionReach = 3.0;
// share of a triangle fan's own mean that evens the triangles along the surface after each
// projection
constexpr double kTangentialRelaxation = 0.3;
constexpr int kProjectionRounds = 5;
// a long pull must point across the surface: one along it comes from an end that has no counterpart
constexpr double kShortPull = 3.0;         // mm
constexpr double kAcrossTheSurface = 0.6;  // cosine
// below this width (mm) the field is carried by all vertices
constexpr double kNarrow = 10.0;

/// Pulls on the vertices of the moving surface.
struct Pulls {
  Points displacement;  ///< V×3, mm
  VecX weight;          ///< V, 0 where there is none
};

Vec3 face_normal(const TriMesh& mesh, Index t) {
  const Vec3 a = mesh.points.row(mesh.triangles(t, 0)), b = mesh.points.row(mesh.triangles(t, 1)),
             c = mesh.points.row(mesh.triangles(t, 2));
  return (b - a).cross(c - a).stableNormalized();
}

bool plausible(const Vec3& pull, const Vec3& normal) {
  const double length = pull.norm();
  return length < kShortPull || std::abs(pull.dot(normal)) > kAcrossTheSurface * length;
}

double trust_at(const TrustedSurface& surface, Index t) {
  if (surface.trust.size() == 0) return 1.0;
  double least = 1.0;
  for (int c = 0; c < 3; ++c) least = std::min(least, surface.trust[surface.mesh.triangles(t, c)]);
  return least;
}

double trust_of(const TrustedSurface& surface, Index v) {
  return surface.trust.size() == 0 ? 1.0 : surface.trust[v];
}

/// From each moving vertex to the nearest compatible point of the target.
void add_forward_pulls(const TrustedSurface& moving, const TrustedSurface& target,
                       const TriangleTree& tree, const RegistrationOptions& options, Pulls& pulls) {
  const Points normals = vertex_normals(moving.mesh);
  parallel_for(moving.mesh.n_vertices(), [&](Index v) {
    const Vec3 p = moving.mesh.points.row(v), normal = normals.row(v);
    const auto hit = tree.nearest_within(p, options.largest_distance);
    if (!hit || face_normal(target.mesh, hit->triangle).dot(normal) < options.normal_limit) return;
    const Vec3 pull = hit->point - p;
    const double weight = trust_of(moving, v) * trust_at(target, hit->triangle);
    if (weight <= 0.0 || !plausible(pull, normal)) return;
    pulls.displacement.row(v) += weight * pull;
    pulls.weight[v] += weight;
  });
}

/// From each target vertex back: the moving triangle nearest to it is pulled there.
void add_backward_pulls(const TrustedSurface& moving, const TrustedSurface& target,
                        const Points& target_normals, const RegistrationOptions& options,
                        Pulls& pulls) {
  const TriangleTree tree(moving.mesh.points, moving.mesh.triangles);
  const Index n = target.mesh.n_vertices();
  std::vector<std::optional<NearestPoint>> hits(static_cast<std::size_t>(n));
  parallel_for(n, [&](Index v) {
    const Vec3 p = target.mesh.points.row(v), normal = target_normals.row(v);
    const auto hit = tree.nearest_within(p, options.largest_distance);
    if (!hit || face_normal(moving.mesh, hit->triangle).dot(normal) < options.normal_limit) return;
    const bool trusted = trust_of(target, v) > 0.0 && trust_at(moving, hit->triangle) > 0.0;
    if (trusted && plausible(p - hit->point, normal)) hits[static_cast<std::size_t>(v)] = hit;
  });
  // a fine target must not outweigh the moving surface's own pulls
  const double share = static_cast<double>(moving.mesh.n_vertices()) / n;
  for (Index v = 0; v < n; ++v) {
    const auto& hit = hits[static_cast<std::size_t>(v)];
    if (!hit) continue;
    const Vec3 pull = Vec3(target.mesh.points.row(v)) - hit->point;
    for (int c = 0; c < 3; ++c) {
      const Index corner = moving.mesh.triangles(hit->triangle, c);
      const double weight = share * hit->barycentric[c];
      pulls.displacement.row(corner) += weight * pull;
      pulls.weight[corner] += weight;
    }
  }
}

Pulls compute_pulls(const TrustedSurface& moving, const TrustedSurface& target,
                    const TriangleTree& tree, const Points& target_normals,
                    const RegistrationOptions& options) {
  const Index n = moving.mesh.n_vertices();
  Pulls pulls{Points::Zero(n, 3), VecX::Zero(n)};
  add_forward_pulls(moving, target, tree, options, pulls);
  add_backward_pulls(moving, target, target_normals, options, pulls);
  for (Index v = 0; v < n; ++v) {
    if (pulls.weight[v] > 0.0) pulls.displacement.row(v) /= pulls.weight[v];
  }
  return pulls;
}

void update_similarity(TriMesh& moving, const Pulls& pulls) {
  const Points goal = moving.points + pulls.displacement;
  const Similarity fit = fit_similarity(moving.points, goal, pulls.weight);
  moving.points = transformed(fit.scale * moving.points, fit.X);
}

/// Moves every vertex to the mean of its neighbours' fan, along the surface only.
void relax_tangentially(TriMesh& mesh) {
  const Points normals = vertex_normals(mesh);
  Points sum = Points::Zero(mesh.n_vertices(), 3);
  VecX count = VecX::Zero(mesh.n_vertices());
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const Index v = mesh.triangles(t, c), w = mesh.triangles(t, (c + 1) % 3);
      sum.row(v) += mesh.points.row(w);
      count[v] += 1.0;
    }
  }
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (count[v] == 0.0) continue;
    const Vec3 move = sum.row(v).transpose() / count[v] - mesh.points.row(v).transpose();
    const Vec3 n = normals.row(v);
    mesh.points.row(v) += kTangentialRelaxation * (move - n * n.dot(move));
  }
}

void project(TrustedSurface& moving, const TrustedSurface& target, const TriangleTree& tree,
             const RegistrationOptions& options) {
  RegistrationOptions near = options;
  near.largest_distance = kProjectionReach;
  for (int round = 0; round < kProjectionRounds; ++round) {
    relax_tangentially(moving.mesh);
    Pulls pulls{Points::Zero(moving.mesh.n_vertices(), 3), VecX::Zero(moving.mesh.n_vertices())};
    add_forward_pulls(moving, target, tree, near, pulls);
    moving.mesh.points += pulls.displacement;
  }
}

void check_options(const RegistrationOptions& options) {
  require(options.iterations >= 1, "registration needs at least one iteration, got ",
          options.iterations);
  require(options.largest_distance > 0.0, "largest_distance must be positive, got ",
          options.largest_distance);
  for (const double width : options.widths)
    require(width > 0.0, "widths must be positive, got ", width);
}

}  // namespace

Points smooth_field(const Points& centres, const Points& displacements, const VecX& weights,
                    const Points& points, double width) {
  // thin the centres evenly: a wide Gaussian does not see the difference
  const Index stride =
      width < kNarrow ? 1 : std::max<Index>(1, static_cast<Index>(centres.rows()) / kMostCentres);
  const double reach = 3.0 * width, factor = -0.5 / (width * width);
  Points field(points.rows(), 3);
  parallel_for(points.rows(), [&](Index i) {
    Vec3 sum = Vec3::Zero();
    double total = 1e-9;  // far from every centre the field fades to zero
    for (Index j = 0; j < centres.rows(); j += stride) {
      if (weights[j] <= 0.0) continue;
      const double squared = (centres.row(j) - points.row(i)).squaredNorm();
      if (squared > reach * reach) continue;
      const double w = weights[j] * std::exp(factor * squared);
      sum += w * displacements.row(j).transpose();
      total += w;
    }
    field.row(i) = sum / total;
  });
  return field;
}

Points register_surface(const TrustedSurface& moving, const TrustedSurface& target,
                        const RegistrationOptions& options, const Monitor& monitor) {
  check_options(options);
  const TriangleTree tree(target.mesh.points, target.mesh.triangles);
  const Points target_normals = vertex_normals(target.mesh);
  TrustedSurface current = moving;
  for (int i = 0; i < options.similarity_iterations; ++i) {
    update_similarity(current.mesh, compute_pulls(current, target, tree, target_normals, options));
  }
  for (const double width : options.widths) {
    monitor.check_cancelled();
    for (int i = 0; i < options.iterations; ++i) {
      const Pulls pulls = compute_pulls(current, target, tree, target_normals, options);
      Points& points = current.mesh.points;
      points += smooth_field(points, pulls.displacement, pulls.weight, points, width);
    }
  }
  project(current, target, tree, options);
  return current.mesh.points;
}

}  // namespace coxa::shape
