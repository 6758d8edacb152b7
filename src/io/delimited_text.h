#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace coxa::io {

/// Lines of a text file without their line ends. @throws Error bad_file if it cannot be opened
std::vector<std::string> read_lines(const std::filesystem::path& path);

/// Cells between separators, blanks around them removed.
std::vector<std::string> split(const std::string& line, char separator);

/// A whole cell as a number, whatever the locale.
/// @throws Error bad_file naming file, line (from 1) and `what` when it is none
double parse_number(const std::string& cell, const std::string& file, std::size_t line,
                    const std::string& what);

/// A CSV table with a header line; lines that start with # are comments.
struct CsvTable {
  std::string file;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> lines;     ///< line number of each row, from 1
  std::vector<std::string> comments;  ///< without the #

  /// Number of the column. @throws Error bad_file naming the columns there are, when it is absent
  std::size_t column(const std::string& name) const;
  bool has(const std::string& name) const;
  double number(std::size_t row, std::size_t column) const;
};
CsvTable read_csv(const std::filesystem::path& path);

}  // namespace coxa::io
