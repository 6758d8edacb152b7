#include <coxa/io/landmarks.h>

#include <coxa/core/error.h>
#include <coxa/io/csv.h>
#include <coxa/io/files.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace coxa::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Landmarks = std::map<std::string, Vec3>;

void add(Landmarks& landmarks, const std::string& name, const Vec3& p, const std::string& source) {
  require(!name.empty(), source, ": a landmark has no name");
  require(p.allFinite(), source, ": landmark ", name, " is not finite");
  require(landmarks.emplace(name, p).second, source, ": landmark ", name, " is there twice");
}

/// Factors that take the list's coordinates to LPS; Slicer also writes the system as a number.
Vec3 to_lps(const Json& markup, const std::string& source) {
  const Json system = markup.value("coordinateSystem", Json("LPS"));
  const std::string text = system.is_string() ? system.get<std::string>() : system.dump();
  if (text == "LPS" || text == "1") return Vec3::Ones();
  if (text == "RAS" || text == "0") return {-1, -1, 1};
  fail(ErrorCode::bad_input, source, ": coordinateSystem '", text, "' is neither LPS nor RAS");
}

Landmarks parse_markups(const std::string& bytes, const std::string& source) {
  Landmarks landmarks;
  try {
    const Json document = Json::parse(bytes);
    for (const Json& markup : document.at("markups")) {
      const Vec3 factors = to_lps(markup, source);
      for (const Json& point : markup.at("controlPoints")) {
        if (point.value("positionStatus", "defined") != "defined") continue;
        const auto p = point.at("position").get<std::vector<double>>();
        require(p.size() == 3, source, ": a position needs three numbers");
        add(landmarks, point.at("label").get<std::string>(),
            factors.cwiseProduct(Vec3(p[0], p[1], p[2])), source);
      }
    }
  } catch (const Json::exception& error) {
    fail(ErrorCode::bad_file, source, " is not a markups file: ", error.what());
  }
  return landmarks;
}

double number(const std::string& cell, const std::string& source, int line) {
  std::istringstream text(cell);
  double value = 0.0;
  if (!(text >> value))
    fail(ErrorCode::bad_file, source, ":", line, ": '", cell, "' is not a number");
  return value;
}

Landmarks parse_csv(const std::string& bytes, const std::string& source) {
  std::istringstream stream(bytes);
  std::string line;
  std::getline(stream, line);
  const std::vector<std::string> header = csv_cells(line);
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin());
  };
  const std::size_t name = column("name"), x = column("x"), y = column("y"), z = column("z");
  const std::size_t kind = column("kind"), last = std::max({name, x, y, z});
  if (last >= header.size())
    fail(ErrorCode::bad_file, source, ":1: the header needs the columns name, x, y, z");
  Landmarks landmarks;
  for (int n = 2; std::getline(stream, line); ++n) {
    const std::vector<std::string> cells = csv_cells(line);
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (last >= cells.size())
      fail(ErrorCode::bad_file, source, ":", n, ": a row with ", cells.size(), " cells");
    if (kind < cells.size() && cells[kind] != "point") continue;
    add(landmarks, cells[name],
        Vec3(number(cells[x], source, n), number(cells[y], source, n), number(cells[z], source, n)),
        source);
  }
  return landmarks;
}

std::string format_markups(const Landmarks& landmarks) {
  Json points = Json::array();
  for (const auto& [name, p] : landmarks) {
    points.push_back({{"id", std::to_string(points.size() + 1)},
                      {"label", name},
                      {"position", {p[0], p[1], p[2]}},
                      {"positionStatus", "defined"}});
  }
  const Json markup = {{"type", "Fiducial"},
                       {"coordinateSystem", "LPS"},
                       {"coordinateUnits", "mm"},
                       {"controlPoints", points}};
  const char* schema =
      "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/"
      "Schema/"
      "markups-schema-v1.0.3.json#";
  return Json({{"@schema", schema}, {"markups", Json::array({markup})}}).dump(2) + "\n";
}

std::string format_csv(const Landmarks& landmarks) {
  std::ostringstream text;
  text.precision(17);
  text << "name,x,y,z\n";
  for (const auto& [name, p] : landmarks)
    text << name << ',' << p[0] << ',' << p[1] << ',' << p[2] << '\n';
  return text.str();
}

}  // namespace

Landmarks read_landmarks(const fs::path& path) {
  const std::string extension = extension_of(path), source = path.string();
  const bool is_markups = extension == ".mrk.json" || extension == ".json";
  require(is_markups || extension == ".csv", "cannot read landmarks from ", source,
          ": known are .mrk.json and .csv");
  const std::string bytes = read_bytes(path);
  const Landmarks landmarks = is_markups ? parse_markups(bytes, source) : parse_csv(bytes, source);
  require(!landmarks.empty(), source, " holds no landmark");
  return landmarks;
}

void write_landmarks(const fs::path& path, const Landmarks& landmarks) {
  const std::string extension = extension_of(path);
  if (extension == ".mrk.json") return write_bytes(path, format_markups(landmarks));
  if (extension == ".csv") return write_bytes(path, format_csv(landmarks));
  fail(ErrorCode::bad_input, "cannot write landmarks to ", path.string(),
       ": known are .mrk.json and .csv");
}

}  // namespace coxa::io
