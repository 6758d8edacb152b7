#include "delimited_text.h"

#include <coxa/core/error.h>
#include <coxa/io/files.h>

#include <algorithm>
#include <charconv>
#include <sstream>

namespace coxa::io {

std::vector<std::string> read_lines(const std::filesystem::path& path) {
  std::istringstream stream(read_bytes(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(line);
  }
  return lines;
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> cells;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    std::string cell = line.substr(begin, end - begin);
    while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t')) cell.pop_back();
    while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.erase(0, 1);
    cells.push_back(std::move(cell));
    if (end == line.size()) return cells;
    begin = end + 1;
  }
}

double parse_number(const std::string& cell, const std::string& file, std::size_t line,
                    const std::string& what) {
  double value = 0.0;
  const char* begin = cell.data() + (!cell.empty() && cell.front() == '+' ? 1 : 0);
  const char* end = cell.data() + cell.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end) {
    fail(ErrorCode::bad_file, file, ": line ", line, ": ", what, " should be a number, but is '",
         cell, "'");
  }
  return value;
}

std::size_t CsvTable::column(const std::string& name) const {
  const auto it = std::find(columns.begin(), columns.end(), name);
  if (it == columns.end()) {
    std::string there;
    for (const std::string& c : columns) there += (there.empty() ? "" : ", ") + c;
    fail(ErrorCode::bad_file, file, ": no column '", name, "'; there are: ", there);
  }
  return static_cast<std::size_t>(it - columns.begin());
}

bool CsvTable::has(const std::string& name) const {
  return std::find(columns.begin(), columns.end(), name) != columns.end();
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  return parse_number(rows[row][column], file, lines[row], columns[column]);
}

CsvTable read_csv(const std::filesystem::path& path) {
  CsvTable table;
  table.file = path.string();
  const std::vector<std::string> lines = read_lines(path);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (lines[k].empty()) continue;
    if (lines[k].front() == '#') {
      table.comments.push_back(lines[k].substr(1));
      continue;
    }
    std::vector<std::string> cells = split(lines[k], ',');
    if (table.columns.empty()) {
      table.columns = std::move(cells);
      continue;
    }
    if (cells.size() != table.columns.size()) {
      fail(ErrorCode::bad_file, table.file, ": line ", k + 1, " has ", cells.size(),
           " cells, the header ", table.columns.size());
    }
    table.rows.push_back(std::move(cells));
    table.lines.push_back(k + 1);
  }
  if (table.rows.empty()) fail(ErrorCode::bad_file, table.file, ": no line of numbers");
  return table;
}

}  // namespace coxa::io
