#include <coxa/io/surfaces.h>

#include <coxa/io/files.h>

#include "io/test_files.h"

namespace coxa::io {
namespace {

const std::filesystem::path kShared = COXA_SHARED_DIR "/data";

TriMesh tetrahedron() {
  TriMesh mesh;
  mesh.points.resize(4, 3);
  mesh.points << 0.1, 0, 0, 1, 0.25, 0, 0, 1, 0.125, 0, 0, 1.0 / 3.0;
  mesh.triangles.resize(4, 3);
  mesh.triangles << 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2;
  return mesh;
}

Surface with_fields() {
  Surface surface{tetrahedron(), {}};
  surface.fields["confidence"] = VecX::LinSpaced(4, 0.1, 1.0);
  surface.fields["thickness_mm"] = VecX::LinSpaced(4, 3.0, -1e-9);
  return surface;
}

TEST(Surfaces, ComeBackExactlyFromPlyVtpAndObj) {
  const TestFolder folder;
  for (const char* name : {"a.ply", "a.vtp", "a.obj"}) {
    SCOPED_TRACE(name);
    write_surface(folder / name, tetrahedron());
    const TriMesh mesh = read_surface(folder / name);
    EXPECT_EQ(mesh.points, tetrahedron().points);
    EXPECT_EQ(mesh.triangles, tetrahedron().triangles);
  }
}
TEST(Surfaces, StlMergesCornersAndKeepsOrientation) {
  const TestFolder folder;
  write_surface(folder / "a.stl", tetrahedron());
  const TriMesh mesh = read_surface(folder / "a.stl");
  ASSERT_EQ(mesh.n_vertices(), 4);
  ASSERT_EQ(mesh.n_triangles(), 4);
  for (Index t = 0; t < 4; ++t) {
    for (int c = 0; c < 3; ++c) {
      const Vec3 expected = tetrahedron().points.row(tetrahedron().triangles(t, c));
      EXPECT_LT((Vec3(mesh.points.row(mesh.triangles(t, c))) - expected).norm(), 1e-7);
    }
  }
}
TEST(Surfaces, FieldsComeBackFromPlyAndVtp) {
  const TestFolder folder;
  for (const char* name : {"a.ply", "a.vtp"}) {
    SCOPED_TRACE(name);
    write_surface(folder / name, with_fields());
    const Surface surface = read_surface_with_fields(folder / name);
    EXPECT_EQ(surface.fields, with_fields().fields);
  }
}
TEST(Surfaces, FieldOfAnotherLengthIsRefused) {
  const TestFolder folder;
  Surface surface = with_fields();
  surface.fields["confidence"].resize(3);
  const auto write = [&] { write_surface(folder / "a.vtp", surface); };
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, write), "confidence"));
}
TEST(Surfaces, AsciiPlyWithQuadsAndColoursIsRead) {
  const TestFolder folder;
  write_bytes(folder / "a.ply",
              "ply\r\nformat ascii 1.0\r\ncomment bone_side_faces 7\r\nelement vertex "
              "4\r\nproperty float x\r\n"
              "property float y\r\nproperty float z\r\nproperty uchar red\r\nelement face 1\r\n"
              "property list uchar int vertex_indices\r\nend_header\r\n0 0 0 9\r\n1 0 0 9\r\n1 1 0 "
              "9\r\n0 1 0 9\r\n"
              "4 0 1 2 3\r\n");
  const Surface surface = read_surface_with_fields(folder / "a.ply");
  EXPECT_EQ(surface.mesh.n_triangles(), 2);
  EXPECT_TRUE(surface.fields.empty());
  EXPECT_EQ(read_bone_side_faces(folder / "a.ply"), 7);
}
TEST(Surfaces, AsciiStlAndObjWithTexturesAreRead) {
  const TestFolder folder;
  write_bytes(folder / "a.stl",
              "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   "
              "vertex 0 1e0 0\n"
              "  endloop\n endfacet\nendsolid a\n");
  EXPECT_EQ(read_surface(folder / "a.stl").n_vertices(), 3);
  write_bytes(folder / "a.obj",
              "# comment\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\nf -3//1 -2//1 -1//1\n");
  const TriMesh mesh = read_surface(folder / "a.obj");
  EXPECT_EQ(mesh.n_triangles(), 2);
  EXPECT_EQ(Vec3(mesh.triangles.row(1).cast<double>()), Vec3(0, 1, 2));
}
TEST(Surfaces, BrokenFilesAreNamed) {
  const TestFolder folder;
  write_surface(folder / "a.ply", tetrahedron());
  const std::string ply = read_bytes(folder / "a.ply");
  write_bytes(folder / "cut.ply", ply.substr(0, ply.size() - 5));
  write_bytes(folder / "text.stl", "not a surface");
  write_bytes(folder / "cut.vtp", "<VTKFile type=\"PolyData\"><PolyData>");
  write_bytes(folder / "range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  write_bytes(folder / "word.obj", "v 0 0 zero\n");
  write_bytes(folder / "huge.ply",
              "ply\nformat ascii 1.0\nelement vertex 999999999999\nproperty float x\nend_header\n");
  for (const char* name :
       {"cut.ply", "text.stl", "cut.vtp", "range.obj", "word.obj", "huge.ply", "absent.ply"}) {
    const auto read = [&] { read_surface(folder / name); };
    EXPECT_TRUE(contains(error_text(ErrorCode::bad_file, read), name)) << name;
  }
  write_bytes(folder / "empty.obj", "v 0 0 0\n");
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_mesh, [&] { read_surface(folder / "empty.obj"); }),
                       "no triangle"));
}
TEST(Surfaces, RealSurfaceIsRead) {
  const auto path = kShared / "libhip/m1/left/femoral_cartilage.ply";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs " << path;
  const TriMesh mesh = read_surface(path);
  EXPECT_EQ(mesh.n_vertices(), 4104);
  EXPECT_EQ(mesh.n_triangles(), 8208);
  EXPECT_EQ(read_bone_side_faces(path), 4104);
}

}  // namespace
}  // namespace coxa::io
