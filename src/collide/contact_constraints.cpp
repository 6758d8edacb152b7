#include <coxa/collide/surface_contact.h>
#include <coxa/core/parallel.h>

#include <algorithm>

namespace coxa::collide {
namespace {

using Entries = std::vector<std::pair<Index, Vec3>>;

/// Adds to the entry of a particle, of which a constraint has one each.
void add_entry(Index particle, const Vec3& vector, Entries& entries) {
  // where each particle's entry was, last time one was made; a wrong place tells by its particle
  thread_local std::vector<std::size_t> place;
  const auto p = static_cast<std::size_t>(particle);
  if (place.size() <= p) place.resize(2 * p + 1, 0);
  if (place[p] < entries.size() && entries[place[p]].first == particle) {
    entries[place[p]].second += vector;
  } else {
    place[p] = entries.size();
    entries.emplace_back(particle, vector);
  }
}

void append_vertex(const ParticleSurface& surface, Index vertex, const Vec3& slope,
                   Entries& entries) {
  const auto first = static_cast<std::size_t>(surface.row_start[static_cast<std::size_t>(vertex)]);
  const auto last =
      static_cast<std::size_t>(surface.row_start[static_cast<std::size_t>(vertex) + 1]);
  for (std::size_t k = first; k < last; ++k) {
    add_entry(surface.particle[k], surface.weight[k] * slope, entries);
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

/// Closes a constraint: its entries in ascending order of particles.
void SurfaceContact::append_constraint(ContactConstraint constraint, Entries& entries) {
  std::sort(entries.begin(), entries.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  constraint.first = static_cast<Index>(stencil_particles_.size());
  for (const auto& [particle, vector] : entries) {
    stencil_particles_.push_back(particle);
    stencil_vectors_.push_back(vector);
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
                       .area = pair.share * samples_[s].area},
                      entries);
    paired[s] = true;
  }
  for (std::size_t s = 0; s < paired.size(); ++s) {
    if (!paired[s]) forget(s);
  }
}

/// @param wanted  per vertex whether it gets a constraint; empty: all do
void SurfaceContact::make_nodal_constraints(const std::vector<char>& wanted) {
  // pairs around each vertex, with their shares of its area, ascending
  const auto n = multiplier_.size();
  std::vector<std::size_t> start(n + 1, 0);
  const auto for_each_share = [&](const auto& take) {
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      const ContactSample& sample = samples_[static_cast<std::size_t>(pairs_[p].sample)];
      for (int k = 0; k < 3; ++k) {
        const double share = sample.barycentric[k] * sample.area * pairs_[p].share;
        const auto v = static_cast<std::size_t>(slave_.triangles(sample.triangle, k));
        if (share == 0.0 || (!wanted.empty() && !wanted[v])) continue;
        take(v, p, share);
      }
    }
  };
  for_each_share([&](std::size_t v, std::size_t, double) { ++start[v + 1]; });
  for (std::size_t v = 0; v < n; ++v) start[v + 1] += start[v];
  std::vector<std::pair<std::size_t, double>> around(start.back());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for_each_share([&](std::size_t v, std::size_t p, double share) {
    around[next[v]++] = {p, share};
  });

  std::vector<ContactConstraint> made(n);
  std::vector<Entries> entries(n);
  parallel_for(static_cast<std::int64_t>(n), [&](Index vertex) {
    const auto v = static_cast<std::size_t>(vertex);
    ContactConstraint& constraint = made[v];
    constraint.owner = vertex;
    for (std::size_t k = start[v]; k < start[v + 1]; ++k) constraint.area += around[k].second;
    for (std::size_t k = start[v]; k < start[v + 1]; ++k) {
      const ContactPair& pair = pairs_[around[k].first];
      const double weight = around[k].second / constraint.area;
      append_entries(pair, weight, entries[v]);
      constraint.normal += weight * pair.normal;
      constraint.offset += weight * (pair.offset + obstacle_height(pair));
    }
  });
  for (std::size_t v = 0; v < n; ++v) {
    if (start[v] == start[v + 1]) {
      forget(v);
    } else {
      append_constraint(made[v], entries[v]);
    }
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
