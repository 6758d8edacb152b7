#include <coxa/collide/surface_contact.h>

#include <algorithm>

namespace coxa::collide {
namespace {

void append_vertex(const ParticleSurface& surface, Index vertex, const Vec3& slope,
                   std::vector<std::pair<Index, Vec3>>& entries) {
  const auto first = static_cast<std::size_t>(surface.row_start[static_cast<std::size_t>(vertex)]);
  const auto last =
      static_cast<std::size_t>(surface.row_start[static_cast<std::size_t>(vertex) + 1]);
  for (std::size_t k = first; k < last; ++k) {
    entries.emplace_back(surface.particle[k], surface.weight[k] * slope);
  }
}

}  // namespace

/// The slope of a pair's gap with the particles, times `share`.
void SurfaceContact::append_entries(const ContactPair& pair, double share, Entries& entries) const {
  const ContactSample& sample = samples_[static_cast<std::size_t>(pair.sample)];
  for (int k = 0; k < 3; ++k) {
    if (sample.barycentric[k] == 0.0) continue;
    append_vertex(slave_, slave_.triangles(sample.triangle, k),
                  share * sample.barycentric[k] * pair.normal, entries);
  }
  if (!other_) return;
  for (int k = 0; k < 3; ++k) {
    append_vertex(*other_, other_->triangles(pair.other_triangle, k),
                  -share * pair.other_barycentric[k] * pair.normal, entries);
  }
}

/// Closes a constraint: one entry a particle, in ascending order.
void SurfaceContact::append_constraint(ContactConstraint constraint, Entries& entries) {
  std::stable_sort(entries.begin(), entries.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  constraint.first = static_cast<Index>(stencil_particles_.size());
  for (std::size_t k = 0; k < entries.size(); ++k) {
    if (k == 0 || entries[k].first != entries[k - 1].first) {
      stencil_particles_.push_back(entries[k].first);
      stencil_vectors_.push_back(entries[k].second);
    } else {
      stencil_vectors_.back() += entries[k].second;
    }
  }
  constraint.last = static_cast<Index>(stencil_particles_.size());
  constraints_.push_back(constraint);
}

/// What an owner that faces nothing any more knew.
void SurfaceContact::forget(std::size_t owner) {
  multiplier_[owner] = overlap_[owner] = 0.0;
  stiffening_[owner] = 1.0;
}

void SurfaceContact::make_pointwise_constraints() {
  std::vector<bool> paired(multiplier_.size(), false);
  Entries entries;
  for (const ContactPair& pair : pairs_) {
    const auto s = static_cast<std::size_t>(pair.sample);
    entries.clear();
    append_entries(pair, 1.0, entries);
    append_constraint({.owner = pair.sample,
                       .normal = pair.normal,
                       .offset = pair.offset + obstacle_height(pair),
                       .area = samples_[s].area},
                      entries);
    paired[s] = true;
  }
  for (std::size_t s = 0; s < paired.size(); ++s) {
    if (!paired[s]) forget(s);
  }
}

void SurfaceContact::make_nodal_constraints() {
  // pairs around each vertex, with their shares of its area
  std::vector<std::vector<std::pair<std::size_t, double>>> around(multiplier_.size());
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const ContactSample& sample = samples_[static_cast<std::size_t>(pairs_[p].sample)];
    for (int k = 0; k < 3; ++k) {
      const double share = sample.barycentric[k] * sample.area;
      if (share == 0.0) continue;
      around[static_cast<std::size_t>(slave_.triangles(sample.triangle, k))].emplace_back(p, share);
    }
  }
  Entries entries;
  for (std::size_t v = 0; v < around.size(); ++v) {
    if (around[v].empty()) {
      forget(v);
      continue;
    }
    ContactConstraint constraint{.owner = static_cast<Index>(v)};
    for (const auto& [p, share] : around[v]) constraint.area += share;
    entries.clear();
    for (const auto& [p, share] : around[v]) {
      const double weight = share / constraint.area;
      append_entries(pairs_[p], weight, entries);
      constraint.normal += weight * pairs_[p].normal;
      constraint.offset += weight * (pairs_[p].offset + obstacle_height(pairs_[p]));
    }
    append_constraint(constraint, entries);
  }
}

/// What a rigid point adds to the offset: its height along the normal; 0 where it is made of
/// particles.
double SurfaceContact::obstacle_height(const ContactPair& pair) const {
  if (other_) return 0.0;
  return pair.normal.dot(other_point(pair, other_mesh_.points));
}

Vec3 SurfaceContact::other_point(const ContactPair& pair, const Points& points) const {
  Vec3 point = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    point += pair.other_barycentric[k] *
             points.row(other_mesh_.triangles(pair.other_triangle, k)).transpose();
  }
  return point;
}

}  // namespace coxa::collide
