#include "mid_nodes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace coxa::meshing {
namespace {

constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
constexpr double kLargestMove = 0.2;  // of the edge's length
constexpr double kLeastRatio = 0.2;   // of the Jacobian determinant to that of the corners

using Barycentric = Eigen::Vector4d;
using Edge = std::pair<Index, Index>;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// determinant of the derivatives of the position by the last three barycentric coordinates
double jacobian(const TenNodes& nodes, const Barycentric& l) {
  std::array<Vec3, 4> slope;
  for (std::size_t k = 0; k < 4; ++k) slope[k] = (4.0 * l[static_cast<int>(k)] - 1.0) * nodes[k];
  for (std::size_t e = 0; e < 6; ++e) {
    const auto i = static_cast<std::size_t>(kEdges[e][0]),
               j = static_cast<std::size_t>(kEdges[e][1]);
    slope[i] += 4.0 * l[kEdges[e][1]] * nodes[4 + e];
    slope[j] += 4.0 * l[kEdges[e][0]] * nodes[4 + e];
  }
  return (slope[1] - slope[0]).cross(slope[2] - slope[0]).dot(slope[3] - slope[0]);
}

// the cubic polynomials' values on a lattice and their Bernstein coefficients
struct CubicBasis {
  std::array<Barycentric, 20> places;
  Eigen::Matrix<double, 20, 20> to_coefficients;

  CubicBasis() {
    constexpr double kFactorial[] = {1.0, 1.0, 2.0, 6.0};
    std::array<std::array<int, 4>, 20> powers{};
    std::size_t n = 0;
    for (int i = 0; i <= 3; ++i)
      for (int j = 0; i + j <= 3; ++j)
        for (int k = 0; i + j + k <= 3; ++k) powers[n++] = {i, j, k, 3 - i - j - k};
    Eigen::Matrix<double, 20, 20> values;
    for (int r = 0; r < 20; ++r) {
      const auto& q = powers[static_cast<std::size_t>(r)];
      places[static_cast<std::size_t>(r)] = Barycentric(q[0], q[1], q[2], q[3]) / 3.0;
      for (int c = 0; c < 20; ++c) {
        double value = 6.0;
        for (int k = 0; k < 4; ++k) {
          const int power = powers[static_cast<std::size_t>(c)][static_cast<std::size_t>(k)];
          value *= std::pow(places[static_cast<std::size_t>(r)][k], power) / kFactorial[power];
        }
        values(r, c) = value;
      }
    }
    to_coefficients = values.inverse();
  }
};

double ratio_of(const TenNodes& n) {
  const double straight = (n[1] - n[0]).cross(n[2] - n[0]).dot(n[3] - n[0]);
  return jacobian_bounds(n).least / straight;
}

std::vector<Edge> edges_of(const TetMesh& mesh) {
  std::vector<Edge> edges;
  for (Index t = 0; t < mesh.n_tets(); ++t)
    for (const auto& e : kEdges)
      edges.push_back(std::minmax(mesh.tets(t, e[0]), mesh.tets(t, e[1])));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

Index number_of(const std::vector<Edge>& edges, Index a, Index b) {
  const Edge e = std::minmax(a, b);
  return static_cast<Index>(std::lower_bound(edges.begin(), edges.end(), e) - edges.begin());
}

// from the middle of each edge to its node; zero inside
std::vector<Vec3> bends_of(const TetMesh& mesh, const std::vector<Edge>& edges,
                           const TriangleTree& surface) {
  std::vector<Vec3> bends(edges.size(), Vec3::Zero());
  for (Index f = 0; f < mesh.facets.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = mesh.points.row(mesh.facets(f, k)),
                 b = mesh.points.row(mesh.facets(f, (k + 1) % 3));
      const Vec3 middle = 0.5 * (a + b), bend = surface.nearest(middle).point - middle;
      const double most = kLargestMove * (b - a).norm(), length = bend.norm();
      bends[at(number_of(edges, mesh.facets(f, k), mesh.facets(f, (k + 1) % 3)))] =
          length > most ? Vec3(most / length * bend) : bend;
    }
  return bends;
}

void place(TetMesh& mesh, Index first, const std::vector<Edge>& edges,
           const std::vector<Vec3>& bends) {
  for (std::size_t e = 0; e < edges.size(); ++e)
    mesh.points.row(first + static_cast<Index>(e)) =
        0.5 * (mesh.points.row(edges[e].first) + mesh.points.row(edges[e].second)) +
        bends[e].transpose();
}

}  // namespace

TenNodes ten_nodes(const TetMesh& mesh, Index t) {
  TenNodes nodes;
  for (int k = 0; k < 4; ++k) nodes[static_cast<std::size_t>(k)] = mesh.points.row(mesh.tets(t, k));
  for (int k = 0; k < 6; ++k)
    nodes[static_cast<std::size_t>(4 + k)] = mesh.points.row(mesh.mid_nodes(t, k));
  return nodes;
}

JacobianBounds jacobian_bounds(const TenNodes& nodes) {
  static const CubicBasis basis;
  Eigen::Matrix<double, 20, 1> values;
  for (int k = 0; k < 20; ++k)
    values[k] = jacobian(nodes, basis.places[static_cast<std::size_t>(k)]);
  const Eigen::Matrix<double, 20, 1> coefficients = basis.to_coefficients * values;
  return {coefficients.minCoeff(), coefficients.maxCoeff()};
}

MidNodeReport update_to_ten_nodes(TetMesh& mesh, const TriangleTree& surface) {
  constexpr double kShrink = 0.6;
  constexpr int kMostRounds = 30;  // after half of them the nodes go all the way back
  const std::vector<Edge> edges = edges_of(mesh);
  const Index first = mesh.n_vertices();
  std::vector<Vec3> bends = bends_of(mesh, edges, surface);
  mesh.points.conservativeResize(first + static_cast<Index>(edges.size()), 3);
  mesh.mid_nodes.resize(mesh.n_tets(), 6);
  for (Index t = 0; t < mesh.n_tets(); ++t)
    for (int k = 0; k < 6; ++k)
      mesh.mid_nodes(t, k) =
          first + number_of(edges, mesh.tets(t, kEdges[k][0]), mesh.tets(t, kEdges[k][1]));
  MidNodeReport report;
  report.n_curved = static_cast<Index>(std::count_if(
      bends.begin(), bends.end(), [](const Vec3& b) { return b.squaredNorm() > 0.0; }));
  std::vector<char> relaxed(edges.size(), 0);
  for (int round = 0; round < kMostRounds; ++round) {
    place(mesh, first, edges, bends);
    report.least_ratio = 1.0;
    std::vector<char> poor(edges.size(), 0);
    for (Index t = 0; t < mesh.n_tets(); ++t) {
      const double ratio = ratio_of(ten_nodes(mesh, t));
      report.least_ratio = std::min(report.least_ratio, ratio);
      for (int k = 0; k < 6 && ratio < kLeastRatio; ++k) poor[at(mesh.mid_nodes(t, k) - first)] = 1;
    }
    if (report.least_ratio >= kLeastRatio) break;
    for (std::size_t e = 0; e < bends.size(); ++e) {
      if (!poor[e] || bends[e].squaredNorm() == 0.0) continue;
      bends[e] *= 2 * round < kMostRounds ? kShrink : 0.0;
      relaxed[e] = 1;
    }
  }
  report.n_relaxed = static_cast<Index>(std::count(relaxed.begin(), relaxed.end(), 1));
  return report;
}

}  // namespace coxa::meshing
