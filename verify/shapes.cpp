#include "shapes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <map>
#include <tuple>

namespace coxa::verify {
namespace {

/// Merges nodes at one place and drops the tets that this flattens.
TetMesh merged(const TetMesh& mesh) {
  TetMesh result;
  std::map<std::tuple<long long, long long, long long>, Index> seen;
  std::vector<Index> to(static_cast<std::size_t>(mesh.n_vertices()));
  std::vector<Vec3> kept;
  for (Index i = 0; i < mesh.n_vertices(); ++i) {
    const auto key = [&](int c) { return std::llround(mesh.points(i, c) * 1e9); };
    const auto [place, is_new] =
        seen.try_emplace({key(0), key(1), key(2)}, static_cast<Index>(kept.size()));
    if (is_new) kept.push_back(mesh.points.row(i));
    to[static_cast<std::size_t>(i)] = place->second;
  }
  result.points.resize(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t i = 0; i < kept.size(); ++i)
    result.points.row(static_cast<Eigen::Index>(i)) = kept[i].transpose();
  std::vector<std::array<Index, 4>> tets;
  for (Index e = 0; e < mesh.n_tets(); ++e) {
    std::array<Index, 4> tet;
    for (int a = 0; a < 4; ++a)
      tet[static_cast<std::size_t>(a)] = to[static_cast<std::size_t>(mesh.tets(e, a))];
    Mat3 D;
    for (int a = 1; a < 4; ++a)
      D.col(a - 1) =
          result.points.row(tet[static_cast<std::size_t>(a)]) - result.points.row(tet[0]);
    if (D.determinant() > 1e-12) tets.push_back(tet);
  }
  result.tets.resize(static_cast<Eigen::Index>(tets.size()), 4);
  for (std::size_t e = 0; e < tets.size(); ++e)
    for (std::size_t a = 0; a < 4; ++a)
      result.tets(static_cast<Eigen::Index>(e), static_cast<Eigen::Index>(a)) = tets[e][a];
  return result;
}

}  // namespace

TetMesh quadratic_mesh(const Grid& grid) {
  TetMesh mesh = fem::test::block(grid.nx, grid.ny, grid.nz, Vec3::Ones());
  for (Index k = 0; k <= grid.nz; ++k)
    for (Index j = 0; j <= grid.ny; ++j)
      for (Index i = 0; i <= grid.nx; ++i)
        mesh.points.row(i + (grid.nx + 1) * (j + (grid.ny + 1) * k)) =
            grid.position(i, j, k).transpose();
  return fem::test::with_mid_nodes(merged(mesh));
}

TetMesh corners_only(const TetMesh& mesh) {
  TetMesh linear;
  linear.tets = mesh.tets;
  linear.points = mesh.points.topRows(mesh.tets.maxCoeff() + 1);
  return linear;
}

fem::ContactFaces faces_where(const TetMesh& mesh,
                              const std::function<bool(const Vec3&)>& on_surface) {
  // each face of a tet: three corners, and the middles of its edges 01, 12, 20 among mid nodes 01
  // 12 20 03 13 23
  constexpr int kFaces[4][6] = {
      {0, 1, 2, 0, 1, 2}, {0, 1, 3, 0, 4, 3}, {1, 2, 3, 1, 5, 4}, {2, 0, 3, 2, 3, 5}};
  std::vector<std::array<Index, 6>> found;
  for (Index e = 0; e < mesh.n_tets(); ++e)
    for (const auto& face : kFaces) {
      std::array<Index, 6> nodes;
      for (std::size_t a = 0; a < 6; ++a)
        nodes[a] = a < 3 ? mesh.tets(e, face[a]) : mesh.mid_nodes(e, face[a]);
      bool inside = true;
      for (const Index node : nodes)
        inside = inside && on_surface(mesh.points.row(node).transpose());
      if (inside) found.push_back(nodes);
    }
  fem::ContactFaces faces(static_cast<Eigen::Index>(found.size()), 6);
  for (std::size_t f = 0; f < found.size(); ++f)
    for (std::size_t a = 0; a < 6; ++a)
      faces(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(a)) = found[f][a];
  return faces;
}

double Sector::multiplicity() const { return 2.0 * kPi / std::sin(angle); }

Sector make_sector(const std::vector<double>& r, const std::vector<double>& z, double angle) {
  const Grid grid{static_cast<Index>(r.size()) - 1, 1, static_cast<Index>(z.size()) - 1,
                  [&](Index i, Index j, Index k) {
                    const double phi = (j - 0.5) * angle, radius = r[static_cast<std::size_t>(i)];
                    return Vec3(radius * std::cos(phi), radius * std::sin(phi),
                                z[static_cast<std::size_t>(k)]);
                  }};
  return {quadratic_mesh(grid), angle};
}

std::vector<double> graded(double end, int n, double growth) {
  std::vector<double> values{0.0};
  double step = 1.0;
  for (int k = 0; k < n; ++k, step *= growth) values.push_back(values.back() + step);
  const double scale = end / values.back();
  for (double& value : values) value *= scale;
  return values;
}

}  // namespace coxa::verify
