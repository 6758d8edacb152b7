#pragma once

#include <coxa/mesh/surface_set.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace coxa::io {

/// Parsers take the bytes of a file; `source` is what error texts call it.
Surface parse_ply(std::string_view bytes, const std::string& source);
std::vector<std::string> ply_comments(std::string_view bytes);
TriMesh parse_stl(std::string_view bytes, const std::string& source);
TriMesh parse_obj(std::string_view bytes, const std::string& source);
Surface parse_vtp(std::string_view bytes, const std::string& source);

std::string format_ply(const Surface& surface);
std::string format_stl(const TriMesh& mesh);
std::string format_obj(const TriMesh& mesh);
std::string format_vtp(const Surface& surface);

/// Polygons of any size cut into triangle fans.
class TriangleList {
 public:
  void add_polygon(const std::vector<Index>& corners);
  Triangles triangles() const;

 private:
  std::vector<Index> flat_;
};

/// n×3 points from x y z x y z …
Points points_from(const std::vector<double>& flat);

}  // namespace coxa::io
