#include "result_frames.h"

#include <coxa/core/error.h>
#include <coxa/io/csv.h>
#include <coxa/io/files.h>
#include <coxa/io/tets.h>

#include <cmath>
#include <cstdlib>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

/// sqrt(2/3 dev E : dev E) of a row of nine components.
double effective(const Eigen::RowVectorXd& nine) {
  Mat3 E;
  for (int i = 0; i < 9; ++i) E(i / 3, i % 3) = nine[i];
  const Mat3 deviator = E - Mat3::Identity() * (E.trace() / 3.0);
  return std::sqrt(2.0 / 3.0) * deviator.norm();
}

VecX vertex_strain(const TetMesh& mesh, const MatX& strain) {
  VecX sum = VecX::Zero(mesh.n_vertices()), count = sum;
  for (Index e = 0; e < mesh.n_tets(); ++e) {
    const double value = effective(strain.row(e));
    for (int c = 0; c < 4; ++c) {
      sum[mesh.tets(e, c)] += value;
      count[mesh.tets(e, c)] += 1.0;
    }
  }
  return sum.cwiseQuotient(count.cwiseMax(1.0));
}

Triangles articular_facets(const TetMesh& mesh) {
  std::vector<Index> kept;
  for (Index f = 0; f < mesh.facets.rows(); ++f) {
    if (mesh.facet_tags[static_cast<std::size_t>(f)] == FacetTag::articular_side) kept.push_back(f);
  }
  Triangles facets(static_cast<Index>(kept.size()), 3);
  for (Index i = 0; i < facets.rows(); ++i)
    facets.row(i) = mesh.facets.row(kept[static_cast<std::size_t>(i)]);
  return facets;
}

}  // namespace

std::string FrameRow::cell(const std::string& column) const {
  const auto it = cells.find(column);
  return it == cells.end() ? "" : it->second;
}

double FrameRow::number(const std::string& column) const {
  const std::string text = cell(column);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return text.empty() || *end != '\0' ? kNaN : value;
}

ResultFrames read_result_frames(const fs::path& joint_folder) {
  const fs::path path = joint_folder / "summary.csv";
  std::istringstream lines(io::read_bytes(path));
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> names = io::csv_cells(line);
  ResultFrames frames{joint_folder, {}};
  while (std::getline(lines, line)) {
    const std::vector<std::string> cells = io::csv_cells(line);
    if (cells.size() != names.size()) {
      fail(ErrorCode::bad_file, path.string(), ": a line has ", cells.size(), " cells, the header ",
           names.size());
    }
    FrameRow row;
    for (std::size_t i = 0; i < names.size(); ++i) row.cells[names[i]] = cells[i];
    frames.rows.push_back(std::move(row));
  }
  return frames;
}

ArticularMap read_articular_map(const ResultFrames& frames, const FrameRow& row) {
  char name[40];
  std::snprintf(name, sizeof name, "acetabular_%04d.vtu", static_cast<int>(row.number("frame")));
  const io::TetFile file = io::read_tets_with_fields(frames.folder / "frames" / name);
  ArticularMap map;
  map.surface = {file.mesh.points - Points(file.fields.at_points.at("displacement_mm")),
                 articular_facets(file.mesh)};
  map.effective_strain = vertex_strain(file.mesh, file.fields.at_tets.at("green_strain"));
  map.pressure = file.fields.at_points.at("contact_pressure_MPa");
  return map;
}

}  // namespace coxa::pipeline
