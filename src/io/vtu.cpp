#include <coxa/core/error.h>

#include "tet_formats.h"
#include "vtk_support.h"

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <array>
#include <vector>

namespace coxa::io {
namespace {

/// Whole-mesh arrays that carry the tagged boundary.
constexpr const char* kFacets = "coxa_facets";
constexpr const char* kFacetTags = "coxa_facet_tags";

template <class Matrix>
void add_integers(vtkFieldData* data, const char* name, const Matrix& values) {
  vtkNew<vtkIntArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(static_cast<int>(values.cols()));
  array->SetNumberOfTuples(values.rows());
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index c = 0; c < values.cols(); ++c)
      array->SetTypedComponent(i, static_cast<int>(c), values(i, c));
  }
  data->AddArray(array);
}

void read_facets(vtkFieldData* data, const std::string& source, TetMesh& mesh) {
  vtkDataArray* facets = data->GetArray(kFacets);
  vtkDataArray* tags = data->GetArray(kFacetTags);
  if (facets == nullptr || tags == nullptr) return;
  if (facets->GetNumberOfComponents() != 3 ||
      tags->GetNumberOfTuples() != facets->GetNumberOfTuples()) {
    fail(ErrorCode::bad_file, source, ": the arrays ", kFacets, " and ", kFacetTags,
         " do not fit each other");
  }
  mesh.facets = matrix_from_vtk(facets).cast<Index>();
  for (vtkIdType f = 0; f < tags->GetNumberOfTuples(); ++f) {
    mesh.facet_tags.push_back(static_cast<FacetTag>(static_cast<int>(tags->GetComponent(f, 0))));
  }
}

/// Rows of `values` that belong to tetrahedra.
MatX rows_of(const MatX& values, const std::vector<vtkIdType>& cells) {
  MatX rows(static_cast<Eigen::Index>(cells.size()), values.cols());
  for (std::size_t c = 0; c < cells.size(); ++c)
    rows.row(static_cast<Eigen::Index>(c)) = values.row(cells[c]);
  return rows;
}

std::map<std::string, MatX> fields_from(vtkDataSetAttributes* attributes) {
  std::map<std::string, MatX> fields;
  for (int a = 0; a < attributes->GetNumberOfArrays(); ++a) {
    vtkDataArray* array = attributes->GetArray(a);
    if (array != nullptr && array->GetName() != nullptr)
      fields[array->GetName()] = matrix_from_vtk(array);
  }
  return fields;
}

/// Numbers of the cells that are tetrahedra of one kind: ten-node ones where there is any.
std::vector<vtkIdType> tetrahedra_of(vtkUnstructuredGrid* grid, int& type) {
  std::vector<vtkIdType> linear, quadratic;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    if (grid->GetCellType(c) == VTK_TETRA) linear.push_back(c);
    if (grid->GetCellType(c) == VTK_QUADRATIC_TETRA) quadratic.push_back(c);
  }
  type = quadratic.empty() ? VTK_TETRA : VTK_QUADRATIC_TETRA;
  return quadratic.empty() ? linear : quadratic;
}

}  // namespace

TetFile parse_vtu(std::string_view bytes, const std::string& source) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  read_xml(*reader, bytes, source);
  vtkUnstructuredGrid* grid = reader->GetOutput();
  TetFile file;
  file.mesh.points = points_from_vtk(grid->GetPoints());
  int type = VTK_TETRA;
  const std::vector<vtkIdType> cells = tetrahedra_of(grid, type);
  file.mesh.tets.resize(static_cast<Eigen::Index>(cells.size()), 4);
  if (type == VTK_QUADRATIC_TETRA) file.mesh.mid_nodes.resize(file.mesh.tets.rows(), 6);
  for (Index t = 0; t < file.mesh.n_tets(); ++t) {
    vtkIdType n = 0;
    const vtkIdType* nodes = nullptr;
    grid->GetCellPoints(cells[static_cast<std::size_t>(t)], n, nodes);
    for (int c = 0; c < 4; ++c) file.mesh.tets(t, c) = static_cast<Index>(nodes[c]);
    for (int m = 0; m < file.mesh.mid_nodes.cols() && n == 10; ++m) {
      file.mesh.mid_nodes(t, m) = static_cast<Index>(nodes[4 + m]);
    }
  }
  read_facets(grid->GetFieldData(), source, file.mesh);
  file.fields.at_points = fields_from(grid->GetPointData());
  for (const auto& [name, values] : fields_from(grid->GetCellData())) {
    file.fields.at_tets[name] = rows_of(values, cells);
  }
  return file;
}

std::string format_vtu(const TetMesh& mesh, const TetFields& fields) {
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(vtk_points(mesh.points));
  const bool ten_nodes = mesh.mid_nodes.rows() > 0;
  grid->Allocate(mesh.n_tets());
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    std::array<vtkIdType, 10> nodes{};
    for (int c = 0; c < 4; ++c) nodes[static_cast<std::size_t>(c)] = mesh.tets(t, c);
    for (int m = 0; m < 6 && ten_nodes; ++m)
      nodes[static_cast<std::size_t>(4 + m)] = mesh.mid_nodes(t, m);
    grid->InsertNextCell(ten_nodes ? VTK_QUADRATIC_TETRA : VTK_TETRA, ten_nodes ? 10 : 4,
                         nodes.data());
  }
  for (const auto& [name, values] : fields.at_points)
    add_vtk_array(grid->GetPointData(), name, values);
  for (const auto& [name, values] : fields.at_tets)
    add_vtk_array(grid->GetCellData(), name, values);
  if (mesh.facets.rows() > 0) {
    Eigen::Matrix<Index, Eigen::Dynamic, 1> tags(mesh.facets.rows());
    for (Index f = 0; f < tags.rows(); ++f)
      tags[f] = static_cast<Index>(mesh.facet_tags[static_cast<std::size_t>(f)]);
    add_integers(grid->GetFieldData(), kFacets, mesh.facets);
    add_integers(grid->GetFieldData(), kFacetTags, tags);
  }
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetInputData(grid);
  return written_xml(*writer);
}

}  // namespace coxa::io
