#pragma once

#include <coxa/mesh/surface_set.h>

#include <filesystem>
#include <optional>

namespace coxa::io {

/// Triangles of a PLY, STL, OBJ or VTP file (by its extension), LPS mm as in the file.
///
/// Faces with more corners become fans; equal positions of an STL become one vertex.
/// @throws Error bad_file if missing or broken, bad_mesh if it holds no triangle, bad_input if the
///         extension is none of these
TriMesh read_surface(const std::filesystem::path& path);

/// The same with the values per vertex that a PLY or VTP carries (further PLY vertex properties;
/// VTP point arrays with one component). Normals are not kept.
Surface read_surface_with_fields(const std::filesystem::path& path);

/// Writes `.ply` (binary, double), `.stl` (binary, float), `.obj` or `.vtp`; fields go to PLY and
/// VTP.
/// @throws Error bad_input for another extension, bad_file if it cannot be written
void write_surface(const std::filesystem::path& path, const Surface& surface);
void write_surface(const std::filesystem::path& path, const TriMesh& mesh);

/// N of a PLY header comment `bone_side_faces N`: faces 0 … N-1 lie on the bone; nullopt without
/// one.
std::optional<Index> read_bone_side_faces(const std::filesystem::path& path);

}  // namespace coxa::io
