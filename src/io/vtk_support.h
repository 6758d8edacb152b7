#pragma once

#include <coxa/core/error.h>
#include <coxa/core/types.h>

#include <string>
#include <string_view>

#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkExecutive.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkXMLReader.h>
#include <vtkXMLWriter.h>

namespace coxa::io {

/// Keeps the first error VTK reports, instead of letting it print.
class VtkErrors : public vtkCommand {
 public:
  static VtkErrors* New() { return new VtkErrors; }
  void Execute(vtkObject*, unsigned long event, void* data) override {
    if (event == vtkCommand::ErrorEvent && text_.empty()) text_ = static_cast<const char*>(data);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Runs an XML reader on bytes in memory; `source` is what error texts call them.
inline void read_xml(vtkXMLReader& reader, std::string_view bytes, const std::string& source) {
  vtkNew<VtkErrors> errors;
  reader.SetReaderErrorObserver(errors);
  reader.SetParserErrorObserver(errors);
  for (vtkObject* part :
       {static_cast<vtkObject*>(&reader), static_cast<vtkObject*>(reader.GetExecutive())}) {
    part->AddObserver(vtkCommand::ErrorEvent, errors);
    part->AddObserver(vtkCommand::WarningEvent, errors);
  }
  reader.ReadFromInputStringOn();
  reader.SetInputString(std::string(bytes));
  reader.Update();
  if (!errors->text().empty()) fail(ErrorCode::bad_file, source, " is not a whole VTK file");
}

/// What an XML writer makes of its input: compressed, 64-bit numbers as they are.
inline std::string written_xml(vtkXMLWriter& writer) {
  writer.SetDataModeToBinary();
  writer.SetCompressorTypeToZLib();
  writer.WriteToOutputStringOn();
  COXA_ASSERT(writer.Write() == 1);
  return writer.GetOutputString();
}

inline vtkNew<vtkPoints> vtk_points(const Points& points) {
  vtkNew<vtkPoints> result;
  result->SetDataTypeToDouble();
  result->SetNumberOfPoints(points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) result->SetPoint(i, points.row(i).data());
  return result;
}

inline Points points_from_vtk(vtkPoints* points) {
  Points result(points == nullptr ? 0 : points->GetNumberOfPoints(), 3);
  for (Eigen::Index i = 0; i < result.rows(); ++i) points->GetPoint(i, result.row(i).data());
  return result;
}

/// Adds an n×c array (c = 1, 3, 9 …) as Float64.
template <class Matrix>
void add_vtk_array(vtkDataSetAttributes* attributes, const std::string& name,
                   const Matrix& values) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfComponents(static_cast<int>(values.cols()));
  array->SetNumberOfTuples(values.rows());
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index c = 0; c < values.cols(); ++c) {
      array->SetComponent(i, static_cast<int>(c), values(i, c));
    }
  }
  attributes->AddArray(array);
}

/// n×c values of an array.
inline MatX matrix_from_vtk(vtkDataArray* array) {
  MatX values(array->GetNumberOfTuples(), array->GetNumberOfComponents());
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index c = 0; c < values.cols(); ++c) {
      values(i, c) = array->GetComponent(i, static_cast<int>(c));
    }
  }
  return values;
}

}  // namespace coxa::io
