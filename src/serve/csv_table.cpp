#include "csv_table.h"

#include <coxa/core/error.h>
#include <coxa/io/files.h>

#include <charconv>
#include <sstream>

namespace coxa::serve {
namespace {
using Json = nlohmann::json;

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

Json value_of(const std::string& cell) {
  if (cell.empty()) return nullptr;
  double number = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  return error == std::errc() && end == cell.data() + cell.size() ? Json(number) : Json(cell);
}

}  // namespace

Json csv_table(const std::filesystem::path& path) {
  std::istringstream lines(io::read_bytes(path));
  std::string line;
  std::vector<std::string> columns;
  Json rows = Json::array();
  while (std::getline(lines, line)) {
    if (line.empty() || line.front() == '#') continue;
    std::vector<std::string> cells = cells_of(line);
    if (columns.empty()) {
      columns = std::move(cells);
      continue;
    }
    if (cells.size() != columns.size()) {
      fail(coxa::ErrorCode::bad_file, path.string(), ": a line has ", cells.size(),
           " cells, the header ", columns.size());
    }
    Json row = Json::array();
    for (const std::string& cell : cells) row.push_back(value_of(cell));
    rows.push_back(std::move(row));
  }
  return {{"columns", columns}, {"rows", std::move(rows)}};
}

}  // namespace coxa::serve
