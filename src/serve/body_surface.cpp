#include "body_surface.h"

#include <coxa/geom/triangle_tree.h>
#include <coxa/joint/joint_model.h>

#include <cmath>

namespace coxa::serve {
namespace {

// xx yy zz xy yz zx of the Green strain to sqrt(2/3 dev E : dev E)
VecX effective_strain(const MatX& green) {
  VecX values(green.rows());
  for (Index e = 0; e < green.rows(); ++e) {
    const auto E = green.row(e);
    const double mean = E.head<3>().sum() / 3.0;
    const double square =
        (E.head<3>().array() - mean).square().sum() + 2.0 * E.tail<3>().squaredNorm();
    values[e] = std::sqrt(2.0 / 3.0 * square);
  }
  return values;
}

}  // namespace

BodySurface body_surface(const TetMesh& mesh) {
  BodySurface surface;
  std::vector<Index> vertex_of(static_cast<std::size_t>(mesh.n_vertices()), -1);
  surface.triangles.resize(mesh.facets.rows(), 3);
  for (Index f = 0; f < mesh.facets.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      Index& vertex = vertex_of[static_cast<std::size_t>(mesh.facets(f, k))];
      if (vertex < 0) {
        vertex = static_cast<Index>(surface.node_of.size());
        surface.node_of.push_back(mesh.facets(f, k));
      }
      surface.triangles(f, k) = vertex;
    }
    surface.tags.push_back(static_cast<std::uint8_t>(mesh.facet_tags[static_cast<std::size_t>(f)]));
  }
  return surface;
}

MatX at_surface(const BodySurface& surface, const MatX& per_node) {
  MatX rows(static_cast<Index>(surface.node_of.size()), per_node.cols());
  for (Index v = 0; v < rows.rows(); ++v)
    rows.row(v) = per_node.row(surface.node_of[static_cast<std::size_t>(v)]);
  return rows;
}

VecX node_means(const TetMesh& mesh, const VecX& per_tet) {
  VecX sum = VecX::Zero(mesh.n_vertices()), count = sum;
  for (Index e = 0; e < mesh.n_tets(); ++e) {
    for (int c = 0; c < 4; ++c) {
      sum[mesh.tets(e, c)] += per_tet[e];
      count[mesh.tets(e, c)] += 1.0;
    }
  }
  return sum.cwiseQuotient(count.cwiseMax(1.0));
}

VecX surface_thickness(const TetMesh& mesh, const BodySurface& surface) {
  const Triangles articular = joint::facets_with(mesh, FacetTag::articular_side);
  const Triangles bone = joint::facets_with(mesh, FacetTag::bone_side);
  const auto n = static_cast<Index>(surface.node_of.size());
  VecX thickness = VecX::Constant(n, kNaN);
  if (articular.rows() == 0 || bone.rows() == 0) return thickness;
  const TriangleTree to_articular(mesh.points, articular), to_bone(mesh.points, bone);
  std::vector<bool> is_articular(static_cast<std::size_t>(mesh.n_vertices()), false);
  for (const Index node : articular.reshaped()) is_articular[static_cast<std::size_t>(node)] = true;
  for (Index v = 0; v < n; ++v) {
    const Index node = surface.node_of[static_cast<std::size_t>(v)];
    const TriangleTree& other =
        is_articular[static_cast<std::size_t>(node)] ? to_bone : to_articular;
    thickness[v] = std::sqrt(other.nearest(mesh.points.row(node)).squared_distance);
  }
  return thickness;
}

std::map<std::string, VecX> nodal_fields(const TetMesh& mesh, const joint::StressFields& fields) {
  const VecX shear = 0.5 * (fields.principal_stress.col(0) - fields.principal_stress.col(2));
  return {{"effective_strain", node_means(mesh, effective_strain(fields.green_strain))},
          {"von_mises", node_means(mesh, fields.von_mises)},
          {"first_principal_stress", node_means(mesh, fields.principal_stress.col(0))},
          {"third_principal_stress", node_means(mesh, fields.principal_stress.col(2))},
          {"maximum_shear", node_means(mesh, shear)},
          {"first_principal_strain", node_means(mesh, fields.principal_strain.col(0))},
          {"third_principal_strain", node_means(mesh, fields.principal_strain.col(2))}};
}

}  // namespace coxa::serve
