#include <coxa/io/inspect.h>

#include <coxa/io/collection.h>
#include <coxa/io/files.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/tets.h>
#include <coxa/io/volumes.h>

#include "io/dicom_writer.h"
#include "io/test_files.h"

#include <algorithm>

namespace coxa::io {
namespace {

const std::filesystem::path kData = COXA_SHARED_DIR "/data";

bool some(const std::vector<std::string>& lines, const std::string& part) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return contains(line, part); });
}

TriMesh tetrahedron() {
  TriMesh mesh;
  mesh.points.resize(4, 3);
  mesh.points << 0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10;
  mesh.triangles.resize(4, 3);
  mesh.triangles << 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2;
  return mesh;
}

/// Both surfaces in one mesh, the second moved.
TriMesh joined(const TriMesh& a, const TriMesh& b, const Vec3& moved) {
  TriMesh mesh;
  mesh.points.resize(a.points.rows() + b.points.rows(), 3);
  mesh.points << a.points, b.points.rowwise() + moved.transpose();
  mesh.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
  mesh.triangles << a.triangles, (b.triangles.array() + a.n_vertices()).matrix();
  return mesh;
}

TEST(Inspect, ClosedSurfaceIsUsable) {
  const TestFolder folder;
  write_surface(folder / "a.ply", tetrahedron());
  const Inspection result = inspect(folder / "a.ply");
  EXPECT_EQ(result.kind, "surface");
  EXPECT_TRUE(result.usable()) << result.problems[0];
  EXPECT_TRUE(some(result.facts, "4 vertices, 4 triangles"));
}
TEST(Inspect, OpenSurfaceIsNot) {
  const TestFolder folder;
  TriMesh mesh = tetrahedron();
  mesh.triangles.conservativeResize(3, 3);
  write_surface(folder / "a.ply", mesh);
  EXPECT_TRUE(some(inspect(folder / "a.ply").problems, "open boundary"));
}
TEST(Inspect, SelfIntersectingSurfaceIsNot) {
  const TestFolder folder;
  write_surface(folder / "a.ply", joined(tetrahedron(), tetrahedron(), Vec3(1, 1, 1)));
  EXPECT_TRUE(some(inspect(folder / "a.ply").problems, "self-intersection"));
}
TEST(Inspect, ImageTellsGridAndWarnsOfThickSlices) {
  const TestFolder folder;
  Volume volume;
  volume.size = {4, 4, 4};
  volume.spacing = Vec3(1, 1, 7);
  for (int i = 0; i < 64; ++i) volume.values.push_back(static_cast<float>(i));
  write_volume(folder / "a.nii.gz", volume);
  const Inspection result = inspect(folder / "a.nii.gz");
  EXPECT_TRUE(result.usable());
  EXPECT_TRUE(some(result.facts, "4x4x4 voxels of 1x1x7 mm"));
  EXPECT_TRUE(some(result.warnings, "7 mm"));
  std::fill(volume.values.begin(), volume.values.end(), 3.0F);
  write_volume(folder / "b.nii.gz", volume);
  EXPECT_TRUE(some(inspect(folder / "b.nii.gz").problems, "all voxels are 3"));
}
TEST(Inspect, DicomFolderListsItsSeries) {
  const TestFolder folder;
  for (int k = 0; k < 3; ++k) {
    TestSlice slice;
    slice.position[2] = 4 * k;
    write_dicom(folder / ("s" + std::to_string(k) + ".dcm"), slice);
  }
  const Inspection result = inspect(folder.path());
  EXPECT_EQ(result.kind, "DICOM folder");
  EXPECT_TRUE(some(result.facts, "series 3 't1 axial'"));
  EXPECT_FALSE(result.usable());
}
TEST(Inspect, TetrahedraTellTheirQuality) {
  const TestFolder folder;
  TetMesh mesh;
  mesh.points = tetrahedron().points;
  mesh.tets.resize(1, 4);
  mesh.tets << 0, 1, 2, 3;
  write_tets(folder / "a.vtu", mesh);
  const Inspection result = inspect(folder / "a.vtu");
  EXPECT_TRUE(result.usable());
  EXPECT_TRUE(some(result.facts, "1 four-node tetrahedra"));
  EXPECT_TRUE(some(result.warnings, "not tagged"));
  mesh.points(3, 2) = 0.0;
  write_tets(folder / "b.vtu", mesh);
  EXPECT_TRUE(some(inspect(folder / "b.vtu").problems, "1 tetrahedra have no volume"));
}
TEST(Inspect, CsvIsToldApartByItsColumns) {
  const TestFolder folder;
  write_landmarks(folder / "l.csv", {{"asis_right", Vec3(1, 2, 3)}});
  EXPECT_EQ(inspect(folder / "l.csv").kind, "landmarks");
  EXPECT_TRUE(some(inspect(folder / "l.csv").warnings, "six"));
  write_bytes(folder / "m.csv",
              "time_s,flexion_deg,adduction_deg,internal_rotation_deg\n0,0,0,0\n1,90,0,10\n");
  const Inspection movement = inspect(folder / "m.csv");
  EXPECT_EQ(movement.kind, "movement");
  EXPECT_TRUE(some(movement.facts, "up to 90 degrees"));
}
TEST(Inspect, BrokenAndUnknownFilesAreReportedNotThrown) {
  const TestFolder folder;
  write_bytes(folder / "a.nii", "short");
  EXPECT_TRUE(some(inspect(folder / "a.nii").problems, "too short"));
  write_bytes(folder / "a.xyz", "?");
  EXPECT_EQ(inspect(folder / "a.xyz").kind, "unknown");
  EXPECT_FALSE(inspect(folder / "a.xyz").usable());
  write_bytes(folder / "a.toml", "side = ");
  EXPECT_FALSE(inspect(folder / "a.toml").usable());
  std::filesystem::create_directories(folder / "empty");
  EXPECT_FALSE(inspect(folder / "empty").usable());
  write_bytes(folder / "p1/subject.toml", "side = \"right\"\n");
  EXPECT_EQ(inspect(folder / "p1").kind, "subject folder");
  EXPECT_TRUE(
      contains(error_text(ErrorCode::bad_file, [&] { inspect(folder / "no"); }), "does not exist"));
}
TEST(Inspect, RealRecordingsAndImagesAreTold) {
  if (!std::filesystem::exists(kData)) GTEST_SKIP() << "needs " << kData;
  const Inspection gait = inspect(kData / "mri/one_patient/gait.c3d");
  EXPECT_EQ(gait.kind, "markers");
  EXPECT_TRUE(some(gait.facts, "120 Hz"));
  EXPECT_FALSE(inspect(kData / "motion/c3d/bad_parameter_section.c3d").warnings.empty());
  EXPECT_TRUE(some(inspect(kData / "mri/one_patient/dicom").warnings, "6 series"));
  EXPECT_TRUE(inspect(kData / "libhip/m1/left/femur.ply").usable());
}
TEST(Collection, ListsFilesByTimeAndPart) {
  const TestFolder folder;
  write_bytes(folder / "frames/a_0.vtu", "");
  write_bytes(folder / "frames/b_0.vtu", "");
  write_collection(folder / "results.pvd",
                   {{0.5, "femoral", "frames/a_0.vtu"}, {0.5, "<b>", "frames/b_0.vtu"}});
  const std::string text = read_bytes(folder / "results.pvd");
  EXPECT_TRUE(contains(
      text, "<DataSet timestep=\"0.5\" part=\"0\" name=\"femoral\" file=\"frames/a_0.vtu\"/>"));
  EXPECT_TRUE(contains(text, "part=\"1\" name=\"&lt;b>\""));
  const auto absent = [&] { write_collection(folder / "x.pvd", {{0.0, "a", "frames/none.vtu"}}); };
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, absent), "none.vtu"));
}

}  // namespace
}  // namespace coxa::io
