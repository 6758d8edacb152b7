#include "csv_table.h"

#include <coxa/core/error.h>
#include <coxa/io/csv.h>
#include <coxa/io/files.h>

#include <charconv>
#include <sstream>

namespace coxa::serve {
namespace {
using Json = nlohmann::json;

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
    std::vector<std::string> cells = io::csv_cells(line);
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
