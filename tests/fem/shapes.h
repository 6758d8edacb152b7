#pragma once

#include <coxa/core/rng.h>
#include <coxa/mesh/tet_mesh.h>

#include <array>
#include <map>
#include <utility>

namespace coxa::fem::test {

/// Block of nx × ny × nz cells of size h, each cut into six tets (Kuhn); node (i, j, k) is i +
/// (nx+1)(j + (ny+1) k).
inline TetMesh block(Index nx, Index ny, Index nz, const Vec3& h) {
  TetMesh mesh;
  const auto node = [&](Index i, Index j, Index k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  mesh.points.resize((nx + 1) * (ny + 1) * (nz + 1), 3);
  for (Index k = 0; k <= nz; ++k)
    for (Index j = 0; j <= ny; ++j)
      for (Index i = 0; i <= nx; ++i)
        mesh.points.row(node(i, j, k)) = Vec3(h[0] * i, h[1] * j, h[2] * k).transpose();
  mesh.tets.resize(6 * nx * ny * nz, 4);
  constexpr std::array<std::array<int, 3>, 6> kOrders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}}};
  Index e = 0;
  for (Index k = 0; k < nz; ++k)
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i)
        for (std::size_t o = 0; o < 6; ++o, ++e) {
          std::array<Index, 3> at{i, j, k};
          mesh.tets(e, 0) = node(at[0], at[1], at[2]);
          for (int c = 0; c < 3; ++c) {
            ++at[static_cast<std::size_t>(kOrders[o][static_cast<std::size_t>(c)])];
            mesh.tets(e, c + 1) = node(at[0], at[1], at[2]);
          }
          if (o >= 3) std::swap(mesh.tets(e, 2), mesh.tets(e, 3));  // odd orders are left-handed
        }
  return mesh;
}

/// The same mesh with nodes moved by up to `share` of a normal number, irregular but valid.
inline TetMesh shaken(TetMesh mesh, double share, std::uint64_t seed = 1) {
  Rng rng(seed);
  for (Index i = 0; i < mesh.n_vertices(); ++i)
    mesh.points.row(i) +=
        share * Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)).transpose();
  return mesh;
}

/// The same elements with nodes in the middle of their edges.
inline TetMesh with_mid_nodes(TetMesh mesh) {
  constexpr std::array<std::array<int, 2>, 6> kEdges{
      {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  std::map<std::pair<Index, Index>, Index> middle;
  mesh.mid_nodes.resize(mesh.n_tets(), 6);
  std::vector<Vec3> added;
  for (Index e = 0; e < mesh.n_tets(); ++e)
    for (std::size_t k = 0; k < 6; ++k) {
      const Index a = mesh.tets(e, kEdges[k][0]), b = mesh.tets(e, kEdges[k][1]);
      const auto [place, is_new] = middle.try_emplace(
          std::minmax(a, b), mesh.n_vertices() + static_cast<Index>(added.size()));
      if (is_new) added.push_back(0.5 * (mesh.points.row(a) + mesh.points.row(b)).transpose());
      mesh.mid_nodes(e, static_cast<Eigen::Index>(k)) = place->second;
    }
  const Index n = mesh.n_vertices();
  mesh.points.conservativeResize(n + static_cast<Index>(added.size()), 3);
  for (std::size_t k = 0; k < added.size(); ++k)
    mesh.points.row(n + static_cast<Index>(k)) = added[k].transpose();
  return mesh;
}

/// The points one after the other, as particles have them.
inline VecX stacked(const Points& points) {
  VecX x(points.size());
  for (Eigen::Index i = 0; i < points.rows(); ++i) x.segment<3>(3 * i) = points.row(i).transpose();
  return x;
}

inline Mat3 random_matrix(Rng& rng) {
  Mat3 M;
  for (double& value : M.reshaped()) value = rng.normal();
  return M;
}

}  // namespace coxa::fem::test
