#include <coxa/collide/surface_contact.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/vertex_normals.h>

#include <algorithm>
#include <cmath>

#include "cut_samples.h"
#include "pair_search.h"

namespace coxa::collide {
namespace {

// what has no partner within the search distance is looked for so much farther, mm: how far it is
// tells how long it need not be searched for again
constexpr double kLookFarther = 3.0;

}  // namespace

/// Takes from what every sample has of clearance by how much the surfaces may have come nearer
/// since the last search.
void SurfaceContact::update_clearances(const Points& slave, double slide) {
  if (searched_slave_.rows() == slave.rows()) {
    const Points way = slave - searched_slave_;
    const Points other_way = other_mesh_.points - searched_other_;
    const double longest = other_way.rowwise().norm().maxCoeff();
    parallel_for(n_samples(), [&](Index sample) {
      const auto s = static_cast<std::size_t>(sample);
      const auto corners = slave_.triangles.row(samples_[s].triangle);
      if (slide == 1.0 || nearest_[s] < 0) {
        double own = 0.0;
        for (const Index v : corners) own = std::max(own, way.row(v).norm());
        clearance_[s] -= own + longest;
        return;
      }
      Vec3 apart = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        apart += samples_[s].barycentric[k] * way.row(corners[k]).transpose() -
                 other_way.row(other_mesh_.triangles(nearest_[s], k)).transpose() / 3.0;
      }
      const double along = apart.dot(searched_normal_[s]);
      clearance_[s] += std::min(0.0, along) - slide * (apart - along * searched_normal_[s]).norm();
    });
  }
  searched_slave_ = slave;
  searched_other_ = other_mesh_.points;
}

void SurfaceContact::forget_clearances() {
  std::fill(clearance_.begin(), clearance_.end(), -kInfinity);
}

/// Whether each owner has to be searched for; empty: all.
std::vector<char> SurfaceContact::owners_within(double reach) const {
  if (!(reach < kInfinity) || options_.rule != ContactRule::nodal) return {};
  std::vector<char> wanted(multiplier_.size(), 0);
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    if (clearance_[s] > reach) continue;
    for (int k = 0; k < 3; ++k) {
      wanted[static_cast<std::size_t>(slave_.triangles(samples_[s].triangle, k))] = 1;
    }
  }
  return wanted;
}

/// The samples that some wanted owner has a share of, ascending.
std::vector<Index> SurfaceContact::samples_of(const std::vector<char>& wanted) const {
  std::vector<Index> chosen;
  for (Index sample = 0; sample < n_samples(); ++sample) {
    const auto corners = slave_.triangles.row(samples_[static_cast<std::size_t>(sample)].triangle);
    const auto is_wanted = [&](Index v) { return wanted[static_cast<std::size_t>(v)] != 0; };
    if (wanted.empty() || std::any_of(corners.begin(), corners.end(), is_wanted))
      chosen.push_back(sample);
  }
  return chosen;
}

/// How far a sample's pair can come together: by its distance, unless it is inside already.
double SurfaceContact::clearance(const ContactPair& pair, const Vec3& point,
                                 double distance) const {
  const double gap = pair.normal.dot(point - other_point(pair, other_mesh_.points)) - pair.offset;
  return std::min(gap, distance);
}

/// Notes how near a sample without a pair is, for the next search.
void SurfaceContact::note_unpaired(std::size_t s, const Vec3& point,
                                   const std::optional<NearestPoint>& nearest, bool outside) {
  nearest_[s] = nearest ? nearest->triangle : -1;
  if (!nearest) {
    clearance_[s] = options_.search_distance + kLookFarther;
  } else if (!outside) {
    // what is inside, but not faced, may come to be faced anywhere
    clearance_[s] = -kInfinity;
  } else {
    // what is outside presses no sooner than it has come as far as the nearest point
    clearance_[s] = std::sqrt(nearest->squared_distance);
    searched_normal_[s] = (point - nearest->point).normalized();
  }
}

/// Searches for what a sample at `point` faces, and notes what the next search wants to know.
std::optional<ContactPair> SurfaceContact::find_pair(Index sample, const Vec3& point,
                                                     const Vec3& normal, SearchHint hint) {
  const auto s = static_cast<std::size_t>(sample);
  const OtherSurface other{*tree_, other_normals_, other_neighbours_, boundary_vertex_};
  const SampleSearch search = find_faced_point(other, point, normal, nearest_[s], hint, options_);
  if (!search.faced) {
    const auto nearest =
        search.nearest ? search.nearest
                       : tree_->nearest_within(point, options_.search_distance + kLookFarther);
    note_unpaired(s, point, nearest, search.outside);
    return std::nullopt;
  }
  const FacedPoint& faced = *search.faced;
  const double bulges = bulge(slave_bulge_, samples_[s].triangle, samples_[s].barycentric) *
                            -normal.dot(faced.normal) +
                        bulge(other_bulge_, faced.triangle, faced.barycentric);
  const ContactPair pair{
      sample,     faced.triangle, faced.barycentric, faced.normal, options_.minimum_gap + bulges,
      faced.share};
  nearest_[s] = search.nearest->triangle;
  clearance_[s] = clearance(pair, point, std::sqrt(search.nearest->squared_distance));
  searched_normal_[s] = faced.normal;
  return pair;
}

void SurfaceContact::update_pairs(const VecX& x, double reach, double slide) {
  prepare_other(x);
  const TriMesh slave{surface_points(slave_, x), slave_.triangles};
  const bool at_vertices = options_.quadrature == ContactQuadrature::vertices;
  const bool cut = options_.quadrature == ContactQuadrature::cut;
  const Points facet_normals = triangle_normals(slave);
  const Points normals = at_vertices ? vertex_normals(slave) : Points();
  if (cut) {
    samples_ = cut_samples(slave, facet_normals, *tree_, options_.search_distance);
  } else {
    update_areas(triangle_areas(slave));
  }

  if (nearest_.size() != samples_.size()) nearest_.assign(samples_.size(), -1);
  if (clearance_.size() != samples_.size()) clearance_.assign(samples_.size(), -kInfinity);
  searched_normal_.resize(samples_.size(), Vec3::Zero());
  if (!cut) update_clearances(slave.points, slide);
  const std::vector<char> wanted = cut ? std::vector<char>() : owners_within(reach);
  const std::vector<Index> chosen = samples_of(wanted);
  const SearchHint hint = slide == 1.0 ? SearchHint::bounds : SearchHint::followed;
  std::vector<std::optional<ContactPair>> found(chosen.size());
  parallel_for(static_cast<std::int64_t>(chosen.size()), [&](Index k) {
    const auto at = static_cast<std::size_t>(k);
    const ContactSample& sample = samples_[static_cast<std::size_t>(chosen[at])];
    Vec3 point = Vec3::Zero(), vertex_normal = Vec3::Zero();
    for (int c = 0; c < 3; ++c) {
      const Index v = slave_.triangles(sample.triangle, c);
      point += sample.barycentric[c] * slave.points.row(v).transpose();
      if (at_vertices) vertex_normal += sample.barycentric[c] * normals.row(v).transpose();
    }
    const Vec3 normal =
        (at_vertices ? vertex_normal : facet_normals.row(sample.triangle).transpose()).normalized();
    found[at] = find_pair(chosen[at], point, normal, hint);
  });

  pairs_.clear();
  for (const auto& pair : found) {
    if (pair) pairs_.push_back(*pair);
  }
  constraints_.clear();
  stencil_particles_.clear();
  stencil_vectors_.clear();
  if (options_.rule == ContactRule::pointwise) {
    make_pointwise_constraints();
  } else {
    make_nodal_constraints(wanted);
  }
}

}  // namespace coxa::collide
