// tetrahedra from the text formats of other programs
#include <coxa/core/error.h>

#include "tet_formats.h"

#include <array>
#include <map>
#include <sstream>
#include <vector>

namespace coxa::io {
namespace {

template <class T>
T next(std::istream& in, const std::string& source, const char* what) {
  T value{};
  if (!(in >> value)) fail(ErrorCode::bad_file, source, " ends or breaks off within its ", what);
  return value;
}

using Numbers = std::map<long, Index>;  ///< node number in the file -> row

Index row_of(const Numbers& numbers, long number, const std::string& source) {
  const auto found = numbers.find(number);
  if (found == numbers.end())
    fail(ErrorCode::bad_file, source, ": an element names node ", number, ", which is not there");
  return found->second;
}

Numbers read_gmsh_nodes(std::istream& in, const std::string& source, TetMesh& mesh) {
  Numbers numbers;
  const auto n = next<long>(in, source, "nodes");
  require(n >= 0 && n < 100000000, source, ": impossible number of nodes ", n);
  mesh.points.resize(n, 3);
  for (Index i = 0; i < n; ++i) {
    numbers[next<long>(in, source, "nodes")] = i;
    for (int a = 0; a < 3; ++a) mesh.points(i, a) = next<double>(in, source, "nodes");
  }
  return numbers;
}

void read_gmsh_elements(std::istream& in, const Numbers& numbers, const std::string& source,
                        TetMesh& mesh) {
  // nodes of the element types that can appear; 0: unknown
  static const std::map<int, int> kNodes = {{1, 2}, {2, 3}, {3, 4}, {4, 4},  {5, 8},   {6, 6},
                                            {7, 5}, {8, 3}, {9, 6}, {10, 9}, {11, 10}, {15, 1}};
  std::vector<Index> tets, mids, facets;
  const auto n = next<long>(in, source, "elements");
  for (long e = 0; e < n; ++e) {
    next<long>(in, source, "elements");
    const int type = next<int>(in, source, "elements"), n_tags = next<int>(in, source, "elements");
    int group = 0;
    for (int t = 0; t < n_tags; ++t) {
      const int tag = next<int>(in, source, "elements");
      if (t == 0) group = tag;
    }
    const auto known = kNodes.find(type);
    require(known != kNodes.end(), source, ": Gmsh element type ", type, " is not supported");
    std::array<Index, 10> nodes{};
    for (int c = 0; c < known->second; ++c) {
      nodes[static_cast<std::size_t>(c)] =
          row_of(numbers, next<long>(in, source, "elements"), source);
    }
    if (type == kGmshTet || type == kGmshTet10)
      tets.insert(tets.end(), nodes.begin(), nodes.begin() + 4);
    if (type == kGmshTet10) {
      for (const int m : kGmshMid) mids.push_back(nodes[static_cast<std::size_t>(4 + m)]);
    }
    if (type == kGmshTriangle && 1 <= group && group <= 4) {
      facets.insert(facets.end(), nodes.begin(), nodes.begin() + 3);
      mesh.facet_tags.push_back(static_cast<FacetTag>(group - 1));
    }
  }
  require(mids.empty() || mids.size() / 6 == tets.size() / 4, source,
          " mixes four- and ten-node tetrahedra");
  mesh.tets = Eigen::Map<const Tets>(tets.data(), static_cast<Eigen::Index>(tets.size() / 4), 4);
  mesh.mid_nodes = Eigen::Map<const decltype(TetMesh::mid_nodes)>(
      mids.data(), static_cast<Eigen::Index>(mids.size() / 6), 6);
  mesh.facets =
      Eigen::Map<const Triangles>(facets.data(), static_cast<Eigen::Index>(facets.size() / 3), 3);
}

}  // namespace

TetMesh parse_gmsh(const std::string& text, const std::string& source) {
  std::istringstream in(text);
  TetMesh mesh;
  Numbers numbers;
  for (std::string word; in >> word;) {
    if (word == "$MeshFormat") {
      const auto version = next<std::string>(in, source, "header");
      const int binary = next<int>(in, source, "header");
      require(version.starts_with("2.") && binary == 0, source, " is Gmsh ", version,
              binary ? " binary" : "", "; save it as version 2.2 ASCII");
    }
    if (word == "$Nodes") numbers = read_gmsh_nodes(in, source, mesh);
    if (word == "$Elements") read_gmsh_elements(in, numbers, source, mesh);
  }
  return mesh;
}

TetMesh parse_tetgen(const std::string& nodes, const std::string& elements,
                     const std::string& source) {
  const auto without_comments = [](const std::string& text) {
    std::istringstream lines(text);
    std::string kept;
    for (std::string line; std::getline(lines, line);)
      kept += line.substr(0, line.find('#')) + "\n";
    return kept;
  };
  std::istringstream in(without_comments(nodes));
  TetMesh mesh;
  Numbers numbers;
  const auto n = next<long>(in, source, "nodes");
  next<int>(in, source, "nodes");
  const int extra = next<int>(in, source, "nodes") + next<int>(in, source, "nodes");
  require(n >= 0 && n < 100000000, source, ": impossible number of nodes ", n);
  mesh.points.resize(n, 3);
  for (Index i = 0; i < n; ++i) {
    numbers[next<long>(in, source, "nodes")] = i;
    for (int a = 0; a < 3; ++a) mesh.points(i, a) = next<double>(in, source, "nodes");
    for (int a = 0; a < extra; ++a) next<double>(in, source, "nodes");
  }
  std::istringstream rows(without_comments(elements));
  const auto m = next<long>(rows, source, "elements");
  const int corners = next<int>(rows, source, "elements"),
            attributes = next<int>(rows, source, "elements");
  require(corners == 4, source, ": only four-node tetrahedra of TetGen are read, got ", corners,
          " nodes each");
  require(m >= 0 && m < 100000000, source, ": impossible number of elements ", m);
  mesh.tets.resize(m, 4);
  for (Index t = 0; t < m; ++t) {
    next<long>(rows, source, "elements");
    for (int c = 0; c < 4; ++c)
      mesh.tets(t, c) = row_of(numbers, next<long>(rows, source, "elements"), source);
    for (int a = 0; a < attributes; ++a) next<double>(rows, source, "elements");
  }
  return mesh;
}

}  // namespace coxa::io
