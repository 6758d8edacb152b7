#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/fem/results.h>
#include <coxa/joint/simulate.h>

#include "elasticity.h"

namespace coxa::joint {
namespace {

/// xx yy zz xy yz zx of every tensor.
MatX components(const std::vector<Mat3>& tensors) {
  MatX rows(static_cast<Index>(tensors.size()), 6);
  for (Index i = 0; i < rows.rows(); ++i) {
    const Mat3& A = tensors[static_cast<std::size_t>(i)];
    rows.row(i) << A(0, 0), A(1, 1), A(2, 2), A(0, 1), A(1, 2), A(2, 0);
  }
  return rows;
}

void check_displacement(const TetMesh& mesh, const Points& displacement) {
  require(displacement.rows() == mesh.n_vertices(),
          "the frame holds no displacement of this mesh: ", displacement.rows(), " rows for ",
          mesh.n_vertices(), " nodes");
}

/// Fields of the mesh deformed to the nodal positions x.
StressFields fields_of(const TetMesh& mesh, const Points& x, const CartilageMaterial& material) {
  const CartilageElasticity elasticity(mesh, 0, material);
  const Eigen::Map<const VecX> values(x.data(), x.size());
  fem::ElementFields fields = fem::compute_fields(elasticity.by_element(), values);
  elasticity.add_patch_stress(values, fields.cauchy_stress);
  parallel_for(mesh.n_tets(), [&](Index e) {
    const Mat3& stress = fields.cauchy_stress[static_cast<std::size_t>(e)];
    fields.principal_stress.row(e) = fem::principal_values(stress).transpose();
    fields.von_mises[e] = fem::von_mises_stress(stress);
  });
  return {.green_strain = components(fields.green_strain),
          .cauchy_stress = components(fields.cauchy_stress),
          .principal_stress = fields.principal_stress,
          .principal_strain = fields.principal_strain,
          .von_mises = std::move(fields.von_mises)};
}

}  // namespace

StressFields acetabular_fields(const JointModel& model, const FrameResult& frame) {
  const TetMesh& mesh = model.acetabular_cartilage;
  check_displacement(mesh, frame.acetabular_displacement);
  return fields_of(mesh, mesh.points + frame.acetabular_displacement, model.material);
}

StressFields femoral_fields(const JointModel& model, const FrameResult& frame) {
  const TetMesh& mesh = model.femoral_cartilage;
  check_displacement(mesh, frame.femoral_displacement);
  return fields_of(mesh, transformed(mesh.points, frame.X_II) + frame.femoral_displacement,
                   model.material);
}

StressFields labrum_fields(const JointModel& model, const FrameResult& frame) {
  const TetMesh& mesh = model.labrum_body;
  require(mesh.n_tets() > 0, "the model has no soft labrum");
  check_displacement(mesh, frame.labrum_displacement);
  return fields_of(mesh, mesh.points + frame.labrum_displacement, model.labrum_material);
}

}  // namespace coxa::joint
