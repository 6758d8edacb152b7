#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/triangle_list.h>
#include <coxa/shape/ligaments.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "keep_clear.h"

namespace coxa::shape {
namespace {

// mm between nodes of a fibre that is free
constexpr double kSpacing = 2.5;
// mm kept from what is firm
constexpr double kGap = 0.1;
// passes of tightening, and how much of the way to the mean of the neighbours; across the fibres
// less
constexpr int kPasses = 150;
constexpr double kAlong = 0.5, kAcross = 0.1;
// mm: a node this deep in something firm still finds its way out
constexpr double kDeep = 25.0;
// least half thickness, mm, and its share at the borders and where the band ends
constexpr double kLeastHalf = 0.25, kBorderShare = 0.5;

/// Nodes by fibre; ends of a fibre that lie on bone are held.
struct Sheet {
  Index n_fibres = 0, n_nodes = 0;
  std::vector<Vec3> nodes;  // fibre by fibre
  std::vector<char> held;
  Index at(Index fibre, Index node) const { return fibre * n_nodes + node; }
  const Vec3& operator()(Index fibre, Index node) const {
    return nodes[static_cast<std::size_t>(at(fibre, node))];
  }
};

/// k-th of n points evenly along a chain.
Vec3 along(const std::vector<Vec3>& chain, Index k, Index n) {
  const double place =
      static_cast<double>(k) / std::max<Index>(1, n - 1) * static_cast<double>(chain.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), chain.size() - 1);
  const auto high = std::min(low + 1, chain.size() - 1);
  const double share = place - static_cast<double>(low);
  return (1.0 - share) * chain[low] + share * chain[high];
}

std::size_t longest(const std::vector<std::vector<Vec3>>& chains) {
  std::size_t n = 0;
  for (const auto& chain : chains) n = std::max(n, chain.size());
  return n;
}

/// Both ends on bone, between them turning evenly about the head.
Sheet first_sheet(const LigamentSite& site, const Vec3& head_centre) {
  const Index n_from = static_cast<Index>(longest(site.origin)),
              n_to = static_cast<Index>(longest(site.insertion));
  double span = 0.0;
  for (std::size_t j = 0; j < site.origin.size(); ++j)
    span = std::max(span, (site.insertion[j].front() - site.origin[j].back()).norm());
  const Index n_free = std::max<Index>(6, static_cast<Index>(1.3 * span / kSpacing));
  Sheet sheet;
  sheet.n_fibres = static_cast<Index>(site.origin.size());
  sheet.n_nodes = n_from + n_free + n_to;
  for (std::size_t j = 0; j < site.origin.size(); ++j) {
    for (Index k = 0; k < n_from; ++k) sheet.nodes.push_back(along(site.origin[j], k, n_from));
    const Vec3 a = site.origin[j].back() - head_centre, b = site.insertion[j].front() - head_centre;
    for (Index k = 0; k < n_free; ++k) {
      const double s = static_cast<double>(k + 1) / static_cast<double>(n_free + 1);
      const Vec3 d = ((1.0 - s) * a.normalized() + s * b.normalized()).normalized();
      // as near as the straight way: what is in the way pushes it out to where it is tight
      sheet.nodes.push_back(head_centre + ((1.0 - s) * a + s * b).norm() * d);
    }
    for (Index k = 0; k < n_to; ++k) sheet.nodes.push_back(along(site.insertion[j], k, n_to));
    for (Index k = 0; k < sheet.n_nodes; ++k)
      sheet.held.push_back(k < n_from || k >= n_from + n_free);
  }
  return sheet;
}

/// The mean of a node's neighbours along and across, weighted.
Vec3 tightened(const Sheet& sheet, Index j, Index k) {
  const Vec3 p = sheet(j, k);
  Vec3 q = p + kAlong * (0.5 * (sheet(j, k - 1) + sheet(j, k + 1)) - p);
  if (j > 0 && j + 1 < sheet.n_fibres)
    q += kAcross * (0.5 * (sheet(j - 1, k) + sheet(j + 1, k)) - p);
  return q;
}

void update_tight(Sheet& sheet, const std::vector<TriangleTree>& trees, double clearance) {
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<Vec3> next = sheet.nodes;
    parallel_for(sheet.n_fibres * sheet.n_nodes, [&](Index i) {
      const auto n = static_cast<std::size_t>(i);
      if (!sheet.held[n]) next[n] = tightened(sheet, i / sheet.n_nodes, i % sheet.n_nodes);
      // what lies on bone is lifted off it once
      if (sheet.held[n] && pass > 0) return;
      for (const TriangleTree& tree : trees) push_out(next[n], tree, clearance, kDeep);
    });
    sheet.nodes = std::move(next);
  }
}

/// Half the thickness at each node: what the room allows, less at borders and ends.
std::vector<double> half_thickness(const Sheet& sheet, const std::vector<TriangleTree>& trees,
                                   double wanted) {
  std::vector<double> half(sheet.nodes.size());
  parallel_for(static_cast<std::int64_t>(half.size()), [&](Index i) {
    const Index j = i / sheet.n_nodes, k = i % sheet.n_nodes;
    const bool border = j == 0 || j + 1 == sheet.n_fibres || k == 0 || k + 1 == sheet.n_nodes;
    double room = wanted;
    for (const TriangleTree& tree : trees) {
      const auto near = tree.nearest_within(sheet(j, k), wanted);
      if (near) room = std::min(room, std::sqrt(near->squared_distance) - kGap);
    }
    half[static_cast<std::size_t>(i)] =
        std::max(kLeastHalf, std::min(room, wanted) * (border ? kBorderShare : 1.0));
  });
  return half;
}

Vec3 normal_at(const Sheet& sheet, Index j, Index k) {
  const Index a = std::max<Index>(0, j - 1), b = std::min<Index>(sheet.n_fibres - 1, j + 1);
  const Index c = std::max<Index>(0, k - 1), d = std::min<Index>(sheet.n_nodes - 1, k + 1);
  return (sheet(b, k) - sheet(a, k)).cross(sheet(j, d) - sheet(j, c)).normalized();
}

/// Two sheets a thickness apart with walls all around.
TriMesh closed_band(const Sheet& sheet, const std::vector<double>& half) {
  const Index n = sheet.n_fibres * sheet.n_nodes;
  TriMesh mesh;
  mesh.points.resize(2 * n, 3);
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 up = half[k] * normal_at(sheet, i / sheet.n_nodes, i % sheet.n_nodes);
    mesh.points.row(i) = sheet.nodes[k] + up;
    mesh.points.row(n + i) = sheet.nodes[k] - up;
  }
  std::vector<std::array<Index, 3>> triangles;
  const auto quad = [&](Index a, Index b, Index c, Index d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  };
  for (Index j = 0; j + 1 < sheet.n_fibres; ++j) {
    for (Index k = 0; k + 1 < sheet.n_nodes; ++k) {
      const Index a = sheet.at(j, k), b = sheet.at(j + 1, k), c = sheet.at(j + 1, k + 1),
                  d = sheet.at(j, k + 1);
      quad(a, b, c, d);
      quad(n + d, n + c, n + b, n + a);
    }
  }
  const auto wall = [&](Index a, Index b) { quad(b, a, n + a, n + b); };
  const Index last_fibre = sheet.n_fibres - 1, last_node = sheet.n_nodes - 1;
  for (Index j = 0; j < last_fibre; ++j) {
    wall(sheet.at(j, 0), sheet.at(j + 1, 0));
    wall(sheet.at(j + 1, last_node), sheet.at(j, last_node));
  }
  for (Index k = 0; k < last_node; ++k) {
    wall(sheet.at(0, k + 1), sheet.at(0, k));
    wall(sheet.at(last_fibre, k), sheet.at(last_fibre, k + 1));
  }
  mesh.triangles = triangles_from(triangles);
  return mesh;
}

}  // namespace

TriMesh make_ligament(const LigamentSite& site, const Vec3& head_centre,
                      const std::vector<TriMesh>& firm) {
  require(site.origin.size() >= 2 && site.origin.size() == site.insertion.size(),
          "a ligament needs as many fibres at its insertion as at its origin, and two at least");
  std::vector<TriangleTree> trees;
  for (const TriMesh& mesh : firm) trees.emplace_back(mesh.points, mesh.triangles);
  Sheet sheet = first_sheet(site, head_centre);
  update_tight(sheet, trees, 0.5 * site.thickness + kGap);
  TriMesh band = closed_band(sheet, half_thickness(sheet, trees, 0.5 * site.thickness));
  std::vector<Obstacle> obstacles;
  for (const TriangleTree& tree : trees) obstacles.push_back({&tree, kGap});
  update_clear(band, obstacles);
  return band;
}

}  // namespace coxa::shape
