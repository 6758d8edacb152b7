#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace coxa::pipeline {

/// One line of a joint stage's summary.csv.
struct FrameRow {
  std::map<std::string, std::string> cells;
  /// The text of a column; empty where there is none.
  std::string cell(const std::string& column) const;
  /// Its number; NaN where the cell holds none.
  double number(const std::string& column) const;
  bool converged() const { return cell("status") == "converged"; }
};

/// What a joint stage left on disk.
struct ResultFrames {
  std::filesystem::path folder;
  std::vector<FrameRow> rows;
};
/// @throws Error bad_file if summary.csv is missing or broken
ResultFrames read_result_frames(const std::filesystem::path& joint_folder);

/// The acetabular articular side of one frame, in its reference shape, with values per vertex.
struct ArticularMap {
  TriMesh surface;
  VecX effective_strain;  ///< sqrt(2/3 dev E : dev E), mean of the elements at each vertex
  VecX pressure;          ///< MPa
};
ArticularMap read_articular_map(const ResultFrames& frames, const FrameRow& row);

}  // namespace coxa::pipeline
