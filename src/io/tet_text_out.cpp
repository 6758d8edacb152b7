// tetrahedra in the text formats of other programs
#include <coxa/core/error.h>

#include "tet_formats.h"

#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <vector>

namespace coxa::io {
namespace {

constexpr std::array<FacetTag, 4> kTags = {FacetTag::untagged, FacetTag::bone_side,
                                           FacetTag::articular_side, FacetTag::rim};
constexpr int kGmshVolumeGroup =
    10;  ///< physical number of the tetrahedra; facets have their tag plus one

std::ostringstream text_stream() {
  std::ostringstream text;
  text.precision(17);
  return text;
}

bool has_mid_nodes(const TetMesh& mesh) { return mesh.mid_nodes.rows() > 0; }

/// Node numbers from 1, in VTK's order, each after `separator`.
void write_nodes(std::ostream& out, const TetMesh& mesh, Index t, const char* separator) {
  for (int c = 0; c < 4; ++c) out << separator << mesh.tets(t, c) + 1;
  for (int m = 0; m < 6 && has_mid_nodes(mesh); ++m) out << separator << mesh.mid_nodes(t, m) + 1;
}

std::vector<Index> facets_tagged(const TetMesh& mesh, FacetTag tag) {
  std::vector<Index> facets;
  for (Index f = 0; f < mesh.facets.rows(); ++f) {
    if (mesh.facet_tags[static_cast<std::size_t>(f)] == tag) facets.push_back(f);
  }
  return facets;
}

/// Element and side (1-4 in Abaqus's order) of a facet.
struct ElementSide {
  Index tet = 0;
  int side = 0;
};

/// Elements behind the facets, in the facets' order. @throws Error bad_mesh if a facet is on no
/// tetrahedron
std::vector<ElementSide> element_sides(const TetMesh& mesh) {
  std::map<std::array<Index, 3>, ElementSide> sides;
  constexpr int kSides[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};  // Abaqus S1 … S4
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    for (int s = 0; s < 4; ++s) {
      std::array<Index, 3> key;
      for (std::size_t c = 0; c < 3; ++c) key[c] = mesh.tets(t, kSides[s][c]);
      std::sort(key.begin(), key.end());
      sides[key] = {t, s + 1};
    }
  }
  std::vector<ElementSide> result;
  for (Index f = 0; f < mesh.facets.rows(); ++f) {
    std::array<Index, 3> key = {mesh.facets(f, 0), mesh.facets(f, 1), mesh.facets(f, 2)};
    std::sort(key.begin(), key.end());
    const auto found = sides.find(key);
    if (found == sides.end())
      fail(ErrorCode::bad_mesh, "facet ", f, " is not a side of any tetrahedron");
    result.push_back(found->second);
  }
  return result;
}

}  // namespace

std::string format_gmsh(const TetMesh& mesh) {
  std::ostringstream text = text_stream();
  text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n";
  for (const FacetTag tag : kTags)
    text << "2 " << static_cast<int>(tag) + 1 << " \"" << tag_name(tag) << "\"\n";
  text << "3 " << kGmshVolumeGroup << " \"volume\"\n$EndPhysicalNames\n$Nodes\n"
       << mesh.n_vertices() << '\n';
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    text << v + 1 << ' ' << mesh.points(v, 0) << ' ' << mesh.points(v, 1) << ' '
         << mesh.points(v, 2) << '\n';
  }
  text << "$EndNodes\n$Elements\n" << mesh.facets.rows() + mesh.n_tets() << '\n';
  Index number = 1;
  for (Index f = 0; f < mesh.facets.rows(); ++f) {
    const int group = static_cast<int>(mesh.facet_tags[static_cast<std::size_t>(f)]) + 1;
    text << number++ << " 2 2 " << group << ' ' << group;
    for (int c = 0; c < 3; ++c) text << ' ' << mesh.facets(f, c) + 1;
    text << '\n';
  }
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    text << number++ << ' ' << (has_mid_nodes(mesh) ? kGmshTet10 : kGmshTet) << " 2 "
         << kGmshVolumeGroup << ' ' << kGmshVolumeGroup;
    for (int c = 0; c < 4; ++c) text << ' ' << mesh.tets(t, c) + 1;
    for (int m = 0; m < 6 && has_mid_nodes(mesh); ++m)
      text << ' ' << mesh.mid_nodes(t, kGmshMid[static_cast<std::size_t>(m)]) + 1;
    text << '\n';
  }
  text << "$EndElements\n";
  return text.str();
}

std::string format_tetgen_nodes(const TetMesh& mesh) {
  std::ostringstream text = text_stream();
  text << mesh.n_vertices() << " 3 0 0\n";
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    text << v << ' ' << mesh.points(v, 0) << ' ' << mesh.points(v, 1) << ' ' << mesh.points(v, 2)
         << '\n';
  }
  return text.str();
}

std::string format_tetgen_elements(const TetMesh& mesh) {
  std::ostringstream text;
  text << mesh.n_tets() << " 4 0\n";
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    text << t;
    for (int c = 0; c < 4; ++c) text << ' ' << mesh.tets(t, c);
    text << '\n';
  }
  return text.str();
}

std::string format_abaqus(const TetMesh& mesh) {
  std::ostringstream text = text_stream();
  text << "** units mm, N, MPa; frame LPS\n*NODE\n";
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    text << v + 1 << ", " << mesh.points(v, 0) << ", " << mesh.points(v, 1) << ", "
         << mesh.points(v, 2) << '\n';
  }
  text << "*ELEMENT, TYPE=" << (has_mid_nodes(mesh) ? "C3D10" : "C3D4") << ", ELSET=volume\n";
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    text << t + 1;
    write_nodes(text, mesh, t, ", ");
    text << '\n';
  }
  const std::vector<ElementSide> sides = element_sides(mesh);
  for (const FacetTag tag : kTags) {
    const std::vector<Index> facets = facets_tagged(mesh, tag);
    if (facets.empty()) continue;
    text << "*SURFACE, NAME=" << tag_name(tag) << ", TYPE=ELEMENT\n";
    std::vector<bool> in_set(static_cast<std::size_t>(mesh.n_vertices()), false);
    for (const Index f : facets) {
      text << sides[static_cast<std::size_t>(f)].tet + 1 << ", S"
           << sides[static_cast<std::size_t>(f)].side << '\n';
      for (int c = 0; c < 3; ++c) in_set[static_cast<std::size_t>(mesh.facets(f, c))] = true;
    }
    text << "*NSET, NSET=" << tag_name(tag) << "_nodes\n";
    for (std::size_t v = 0; v < in_set.size(); ++v) {
      if (in_set[v]) text << v + 1 << ",\n";
    }
  }
  return text.str();
}

std::string format_febio(const TetMesh& mesh) {
  std::ostringstream text = text_stream();
  text << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- units mm, N, MPa; frame LPS -->\n"
       << "<febio_spec version=\"4.0\">\n<Mesh>\n<Nodes name=\"nodes\">\n";
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    text << "<node id=\"" << v + 1 << "\">" << mesh.points(v, 0) << ',' << mesh.points(v, 1) << ','
         << mesh.points(v, 2) << "</node>\n";
  }
  text << "</Nodes>\n<Elements type=\"" << (has_mid_nodes(mesh) ? "tet10" : "tet4")
       << "\" name=\"volume\">\n";
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    text << "<elem id=\"" << t + 1 << "\">" << mesh.tets(t, 0) + 1;
    for (int c = 1; c < 4; ++c) text << ',' << mesh.tets(t, c) + 1;
    for (int m = 0; m < 6 && has_mid_nodes(mesh); ++m) text << ',' << mesh.mid_nodes(t, m) + 1;
    text << "</elem>\n";
  }
  text << "</Elements>\n";
  for (const FacetTag tag : kTags) {
    const std::vector<Index> facets = facets_tagged(mesh, tag);
    if (facets.empty()) continue;
    text << "<Surface name=\"" << tag_name(tag) << "\">\n";
    for (const Index f : facets) {
      text << "<tri3 id=\"" << f + 1 << "\">" << mesh.facets(f, 0) + 1 << ','
           << mesh.facets(f, 1) + 1 << ',' << mesh.facets(f, 2) + 1 << "</tri3>\n";
    }
    text << "</Surface>\n";
  }
  text << "</Mesh>\n</febio_spec>\n";
  return text.str();
}

}  // namespace coxa::io
