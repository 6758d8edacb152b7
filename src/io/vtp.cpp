#include <coxa/core/error.h>

#include "surface_formats.h"
#include "vtk_support.h"

#include <vtkCellArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>

namespace coxa::io {
namespace {

/// A triangle strip is a zig-zag: every second triangle turns the other way.
void add_strips(vtkCellArray* strips, TriangleList& triangles) {
  vtkIdType n = 0;
  const vtkIdType* corners = nullptr;
  for (strips->InitTraversal(); strips->GetNextCell(n, corners);) {
    for (vtkIdType c = 2; c < n; ++c) {
      const vtkIdType a = c % 2 == 0 ? corners[c - 2] : corners[c - 1];
      const vtkIdType b = c % 2 == 0 ? corners[c - 1] : corners[c - 2];
      triangles.add_polygon(
          {static_cast<Index>(a), static_cast<Index>(b), static_cast<Index>(corners[c])});
    }
  }
}

}  // namespace

Surface parse_vtp(std::string_view bytes, const std::string& source) {
  vtkNew<vtkXMLPolyDataReader> reader;
  read_xml(*reader, bytes, source);
  vtkPolyData* data = reader->GetOutput();
  Surface surface;
  surface.mesh.points = points_from_vtk(data->GetPoints());

  TriangleList triangles;
  vtkIdType n = 0;
  const vtkIdType* corners = nullptr;
  for (data->GetPolys()->InitTraversal(); data->GetPolys()->GetNextCell(n, corners);) {
    triangles.add_polygon(std::vector<Index>(corners, corners + n));
  }
  add_strips(data->GetStrips(), triangles);
  surface.mesh.triangles = triangles.triangles();

  vtkPointData* fields = data->GetPointData();
  for (int a = 0; a < fields->GetNumberOfArrays(); ++a) {
    vtkDataArray* array = fields->GetArray(a);
    if (array == nullptr || array->GetNumberOfComponents() != 1 || array->GetName() == nullptr)
      continue;
    surface.fields[array->GetName()] = matrix_from_vtk(array).col(0);
  }
  return surface;
}

std::string format_vtp(const Surface& surface) {
  const TriMesh& mesh = surface.mesh;
  vtkNew<vtkPolyData> data;
  data->SetPoints(vtk_points(mesh.points));
  vtkNew<vtkCellArray> polygons;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const std::array<vtkIdType, 3> corners = {mesh.triangles(t, 0), mesh.triangles(t, 1),
                                              mesh.triangles(t, 2)};
    polygons->InsertNextCell(3, corners.data());
  }
  data->SetPolys(polygons);
  for (const auto& [name, values] : surface.fields)
    add_vtk_array(data->GetPointData(), name, values);
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(data);
  return written_xml(*writer);
}

}  // namespace coxa::io
