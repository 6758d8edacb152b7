#include <coxa/io/tets.h>

#include <coxa/io/files.h>

#include "io/test_files.h"

namespace coxa::io {
namespace {

/// Two tetrahedra that share a face, with three tagged facets.
TetMesh two_tets() {
  TetMesh mesh;
  mesh.points.resize(5, 3);
  mesh.points << 0, 0, 0, 1, 0, 0, 0, 1.0 / 3.0, 0, 0, 0, 1, 1, 1, 1;
  mesh.tets.resize(2, 4);
  mesh.tets << 0, 1, 2, 3, 1, 2, 3, 4;
  mesh.facets.resize(3, 3);
  mesh.facets << 0, 2, 1, 0, 1, 3, 1, 2, 4;
  mesh.facet_tags = {FacetTag::bone_side, FacetTag::rim, FacetTag::articular_side};
  return mesh;
}

/// One ten-node tetrahedron.
TetMesh ten_nodes() {
  TetMesh mesh;
  mesh.points.resize(10, 3);
  mesh.points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, .5, 0, 0, .5, .5, 0, 0, .5, 0, 0, 0, .5, .5, 0,
      .5, 0, .5, .5;
  mesh.tets.resize(1, 4);
  mesh.tets << 0, 1, 2, 3;
  mesh.mid_nodes.resize(1, 6);
  mesh.mid_nodes << 4, 5, 6, 7, 8, 9;
  return mesh;
}

void expect_same(const TetMesh& a, const TetMesh& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.tets, b.tets);
  ASSERT_EQ(a.mid_nodes.rows(), b.mid_nodes.rows());
  for (Index t = 0; t < a.mid_nodes.rows(); ++t) EXPECT_EQ(a.mid_nodes.row(t), b.mid_nodes.row(t));
}

TEST(Tets, ComeBackExactlyFromVtuGmshAndTetgen) {
  const TestFolder folder;
  for (const char* name : {"a.vtu", "a.msh", "a.node"}) {
    SCOPED_TRACE(name);
    write_tets(folder / name, two_tets());
    expect_same(read_tets(folder / name), two_tets());
  }
  expect_same(read_tets(folder / "a.ele"), two_tets());
}
TEST(Tets, TaggedFacetsComeBackFromVtuAndGmsh) {
  const TestFolder folder;
  for (const char* name : {"a.vtu", "a.msh"}) {
    SCOPED_TRACE(name);
    write_tets(folder / name, two_tets());
    const TetMesh mesh = read_tets(folder / name);
    EXPECT_EQ(mesh.facets, two_tets().facets);
    EXPECT_EQ(mesh.facet_tags, two_tets().facet_tags);
  }
}
TEST(Tets, TenNodeElementsComeBackInTheirOrder) {
  const TestFolder folder;
  for (const char* name : {"a.vtu", "a.msh"}) {
    SCOPED_TRACE(name);
    write_tets(folder / name, ten_nodes());
    expect_same(read_tets(folder / name), ten_nodes());
  }
  // Gmsh lists the edge 2-3 before the edge 1-3
  EXPECT_TRUE(contains(read_bytes(folder / "a.msh"), "1 2 3 4 5 6 7 8 10 9\n"));
}
TEST(Tets, FieldsComeBackInFullPrecision) {
  const TestFolder folder;
  TetFields fields;
  fields.at_points["displacement_mm"] = MatX::Random(5, 3);
  fields.at_tets["von_mises_MPa"] = MatX::Random(2, 1);
  fields.at_tets["cauchy_stress_MPa"] = MatX::Random(2, 9);
  write_tets(folder / "a.vtu", two_tets(), fields);
  const TetFile file = read_tets_with_fields(folder / "a.vtu");
  EXPECT_EQ(file.fields.at_points, fields.at_points);
  EXPECT_EQ(file.fields.at_tets, fields.at_tets);
}
TEST(Tets, NegativeVolumesAreTurned) {
  const TestFolder folder;
  TetMesh mesh = two_tets();
  std::swap(mesh.tets(1, 0), mesh.tets(1, 1));
  write_tets(folder / "a.node", mesh);
  const TetMesh read = read_tets(folder / "a.node");
  EXPECT_EQ(read.tets.row(0), two_tets().tets.row(0));
  EXPECT_EQ(read.tets(1, 2), two_tets().tets(1, 3));
}
TEST(Tets, AbaqusFileNamesElementsSetsAndSides) {
  const TestFolder folder;
  write_tets(folder / "a.inp", two_tets());
  const std::string text = read_bytes(folder / "a.inp");
  EXPECT_TRUE(contains(text, "*ELEMENT, TYPE=C3D4, ELSET=volume\n1, 1, 2, 3, 4\n2, 2, 3, 4, 5\n"));
  EXPECT_TRUE(contains(text, "*SURFACE, NAME=bone_side, TYPE=ELEMENT\n1, S1\n"));
  EXPECT_TRUE(contains(text, "*SURFACE, NAME=rim, TYPE=ELEMENT\n1, S2\n"));
  EXPECT_TRUE(contains(text, "*NSET, NSET=bone_side_nodes\n1,\n2,\n3,\n"));
  write_tets(folder / "b.inp", ten_nodes());
  EXPECT_TRUE(contains(read_bytes(folder / "b.inp"),
                       "TYPE=C3D10, ELSET=volume\n1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10\n"));
}
TEST(Tets, FebioFileHasNodesElementsAndSurfaces) {
  const TestFolder folder;
  write_tets(folder / "a.feb", two_tets());
  const std::string text = read_bytes(folder / "a.feb");
  EXPECT_TRUE(contains(text, "<febio_spec version=\"4.0\">"));
  EXPECT_TRUE(contains(text, "<elem id=\"2\">2,3,4,5</elem>"));
  EXPECT_TRUE(contains(text, "<Surface name=\"articular_side\">\n<tri3 id=\"3\">2,3,5</tri3>"));
}
TEST(Tets, WrongUseIsRefused) {
  const TestFolder folder;
  TetFields fields;
  fields.at_points["u"] = MatX::Zero(4, 3);
  const auto text_of = [](const auto& f) { return error_text(ErrorCode::bad_input, f); };
  EXPECT_TRUE(
      contains(text_of([&] { write_tets(folder / "a.vtu", two_tets(), fields); }), "4 rows"));
  fields.at_points["u"] = MatX::Zero(5, 3);
  EXPECT_TRUE(
      contains(text_of([&] { write_tets(folder / "a.msh", two_tets(), fields); }), ".vtu only"));
  EXPECT_TRUE(contains(text_of([&] { write_tets(folder / "a.node", ten_nodes()); }), "ten-node"));
  EXPECT_TRUE(contains(text_of([&] { write_tets(folder / "a.stl", two_tets()); }), "known are"));
  EXPECT_TRUE(contains(text_of([&] { read_tets(folder / "a.stl"); }), "known are"));
  TetMesh mesh = two_tets();
  mesh.facets(2, 1) = 0;
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_mesh, [&] { write_tets(folder / "a.inp", mesh); }),
                       "facet 2"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}
TEST(Tets, BrokenFilesAreNamed) {
  const TestFolder folder;
  write_tets(folder / "a.msh", two_tets());
  const std::string gmsh = read_bytes(folder / "a.msh");
  write_bytes(folder / "cut.msh", gmsh.substr(0, gmsh.size() - 40));
  write_bytes(folder / "range.msh",
              "$MeshFormat\n2.2 0 8\n$Nodes\n1\n1 0 0 0\n$Elements\n1\n1 4 0 1 2 3 4\n");
  write_tets(folder / "a.vtu", two_tets());
  const std::string vtu = read_bytes(folder / "a.vtu");
  write_bytes(folder / "cut.vtu", vtu.substr(0, vtu.size() / 2));
  write_tets(folder / "cut.node", two_tets());
  write_bytes(folder / "cut.ele", "2 4 0\n0 0 1 2");
  for (const char* name : {"cut.msh", "range.msh", "cut.vtu", "cut.ele", "absent.vtu"}) {
    EXPECT_TRUE(contains(error_text(ErrorCode::bad_file, [&] { read_tets(folder / name); }), name))
        << name;
  }
  write_bytes(folder / "new.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, [&] { read_tets(folder / "new.msh"); }),
                       "2.2 ASCII"));
  write_bytes(folder / "empty.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_mesh, [&] { read_tets(folder / "empty.msh"); }),
                       "no tetrahedron"));
}

}  // namespace
}  // namespace coxa::io
