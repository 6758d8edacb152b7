#pragma once

#include <coxa/io/tets.h>

#include <array>
#include <string>
#include <string_view>

namespace coxa::io {

TetFile parse_vtu(std::string_view bytes, const std::string& source);
TetMesh parse_gmsh(const std::string& text, const std::string& source);
TetMesh parse_tetgen(const std::string& nodes, const std::string& elements,
                     const std::string& source);

std::string format_vtu(const TetMesh& mesh, const TetFields& fields);
std::string format_gmsh(const TetMesh& mesh);
std::string format_tetgen_nodes(const TetMesh& mesh);
std::string format_tetgen_elements(const TetMesh& mesh);
std::string format_abaqus(const TetMesh& mesh);
std::string format_febio(const TetMesh& mesh);

inline constexpr int kGmshTriangle = 2, kGmshTet = 4, kGmshTet10 = 11;
/// Mid-edge nodes in Gmsh's order: its last two are the other way round.
inline constexpr std::array<int, 6> kGmshMid = {0, 1, 2, 3, 5, 4};

/// Name of a facet tag in files: "untagged", "bone_side", "articular_side", "rim".
const char* tag_name(FacetTag tag);

}  // namespace coxa::io
