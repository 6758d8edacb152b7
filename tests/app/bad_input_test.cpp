// What is wrong with the input is said with its place and value, and what to do; the exit code
// tells the kind; nothing half-written is left. The table in docs/pipeline.md names these tests.
#include <coxa/io/atlas_file.h>
#include <coxa/io/files.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/markers.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/volumes.h>
#include <coxa/pipeline/subject.h>
#include <sys/mount.h>

#include "app/command.h"
#include "io/dicom_writer.h"
#include "pipeline/small_run.h"
#include "support/shapes.h"

namespace coxa {
namespace fs = std::filesystem;

using test::coxa_run, test::Outcome;

/// Slices 4 mm apart along +z.
std::vector<io::TestSlice> stack(int n) {
  std::vector<io::TestSlice> slices(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) slices[static_cast<std::size_t>(k)].position = Vec3(0, 0, 4 * k);
  return slices;
}

class BadInput : public test::CommandTest {
 protected:
  /// Refused with this exit code and these words, and without a trace at `out`.
  void expect_refusal(const std::string& arguments, const std::string& out, int exit_code,
                      const std::vector<std::string>& words) {
    const Outcome outcome = coxa_run(arguments + " --quiet --out " + path(out));
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.output;
    for (const std::string& word : words)
      EXPECT_TRUE(outcome.says(word)) << word << "\nis not in\n" << outcome.output;
    EXPECT_TRUE(nothing_at(out)) << outcome.output;
  }
  void expect_dicom_refusal(const std::vector<io::TestSlice>& slices,
                            const std::vector<std::string>& words) {
    for (std::size_t k = 0; k < slices.size(); ++k)
      io::write_dicom(folder_ / "dicom" / (std::to_string(k) + ".dcm"), slices[k]);
    expect_refusal("segment --side right --image " + path("dicom"), "segment", 3, words);
  }
  /// Segments a small image with these landmarks.
  void expect_landmark_refusal(const shape::Landmarks& landmarks,
                               const std::vector<std::string>& words) {
    io::write_volume(folder_ / "image.nii.gz", test::small_image());
    io::write_landmarks(folder_ / "places.mrk.json", landmarks);
    expect_refusal("segment --side right --image " + path("image.nii.gz") + " --landmarks " +
                       path("places.mrk.json"),
                   "segment", 3, words);
  }
  static fs::path atlas() { return pipeline::shipped_data("atlas/hip.coxa-atlas"); }
};
#define SKIP_WITHOUT_ATLAS() \
  if (!fs::exists(atlas())) GTEST_SKIP() << "no shipped atlas"

TEST_F(BadInput, DicomFolderWithTwoSeries) {
  std::vector<io::TestSlice> slices = stack(5);
  for (io::TestSlice second : stack(5)) {
    second.series_uid = "1.2.3.5";
    second.series_number = "12";
    slices.push_back(second);
  }
  expect_dicom_refusal(slices, {"2 series", "select one of them by its id (--series", "series 12"});
}
TEST_F(BadInput, DicomMissingSlice) {
  std::vector<io::TestSlice> slices = stack(8);
  slices.erase(slices.begin() + 3);
  expect_dicom_refusal(slices, {"missing between 2.dcm and 3.dcm", "a gap of 8 mm where 4 mm",
                                "export that series again"});
}
TEST_F(BadInput, DicomDuplicatedSlice) {
  std::vector<io::TestSlice> slices = stack(6);
  slices.push_back(slices[2]);
  expect_dicom_refusal(slices, {"twice", "2.dcm and 6.dcm", "export that series again"});
}
TEST_F(BadInput, DicomSliceCutShort) {
  for (std::size_t k = 0; k < 5; ++k)
    io::write_dicom(folder_ / "dicom" / (std::to_string(k) + ".dcm"), stack(5)[k]);
  const std::string whole = io::dicom_bytes(stack(5)[2]);
  io::write_bytes(folder_ / "dicom/2.dcm", whole.substr(0, whole.size() - 4));
  expect_refusal("segment --side right --image " + path("dicom"), "segment", 3,
                 {"2.dcm is cut short", "12 bytes and 8 are there", "export that series again"});
}
TEST_F(BadInput, DicomLocalizer) {
  std::vector<io::TestSlice> slices = stack(6);
  slices[5].row = Vec3::UnitY();
  slices[5].column = -Vec3::UnitZ();
  expect_dicom_refusal(slices, {"mixed orientations", "a localizer, not a stack"});
}
TEST_F(BadInput, LocalizerAsAFile) {
  Volume image = test::small_image();
  image.size[2] = 3;
  image.values.resize(static_cast<std::size_t>(image.n_voxels()));
  io::write_volume(folder_ / "localizer.nii.gz", image);
  SKIP_WITHOUT_ATLAS();
  expect_refusal("segment --side right --image " + path("localizer.nii.gz"), "segment", 3,
                 {"only 3 voxels along axis 3", "a localizer cannot be segmented"});
}
TEST_F(BadInput, KneeImage) {
  SKIP_WITHOUT_ATLAS();
  // two condyles and a shaft above a plateau, where somebody marked a hip
  Volume knee = test::small_image(30, 4.0);
  for (Index k = 0; k < 30; ++k)
    for (Index j = 0; j < 30; ++j)
      for (Index i = 0; i < 30; ++i) {
        const Vec3 p = knee.position(Vec3(i, j, k));
        const bool condyle = (p - Vec3(24, 0, 8)).norm() < 22 || (p - Vec3(-24, 0, 8)).norm() < 22;
        const bool shaft = p.head<2>().norm() < 15 && p.z() > 8;
        const bool tibia = Vec2(p.x() / 40, p.y() / 26).norm() < 1 && p.z() < -18;
        knee.values[static_cast<std::size_t>(knee.offset(i, j, k))] =
            (condyle || shaft || tibia ? 130.0F : 60.0F) +
            static_cast<float>((7 * i + 3 * j + 5 * k) % 11);
      }
  io::write_volume(folder_ / "knee.nii.gz", knee);
  io::write_landmarks(folder_ / "places.mrk.json", io::read_atlas(atlas()).landmarks);
  expect_refusal("segment --side right --structures femur --contrast t1 --image " +
                     path("knee.nii.gz") + " --landmarks " + path("places.mrk.json"),
                 "segment", 5,
                 {"the hip was not found", "below the least allowed, 0.4",
                  "check side, landmarks and that the hip is in the image"});
}
TEST_F(BadInput, LandmarksOfTheOtherSideByName) {
  SKIP_WITHOUT_ATLAS();
  shape::Landmarks left;
  for (const auto& [name, p] : io::read_atlas(atlas()).landmarks) left[name + "_left"] = p;
  expect_landmark_refusal(left, {"belong to the left hip, but the right one is to be segmented"});
}
TEST_F(BadInput, LandmarksOfTheOtherSideByPlace) {
  SKIP_WITHOUT_ATLAS();
  shape::Landmarks mirrored = io::read_atlas(atlas()).landmarks;
  for (auto& [name, p] : mirrored) p.x() = -p.x();
  expect_landmark_refusal(mirrored, {"look like those of the other hip", "check --side"});
}
TEST_F(BadInput, FewerLandmarksThanNeeded) {
  SKIP_WITHOUT_ATLAS();
  shape::Landmarks few = io::read_atlas(atlas()).landmarks;
  while (few.size() > 5) few.erase(few.begin());
  expect_landmark_refusal(few, {"at least 6 landmarks", "got 5", "it knows"});
}
TEST_F(BadInput, OpenSurface) {
  io::write_surface(folder_ / "sheet.ply", test::plate(0.0));
  expect_refusal("mesh --surface " + path("sheet.ply"), "sheet.vtu", 3,
                 {"sheet.ply", "a hole with a border of 80 mm at (-10, -10, 0) mm"});
}
TEST_F(BadInput, SelfIntersectingSurface) {
  // two shells through each other in one file
  TriMesh both = test::lunate_shell(8.0, 1.2, radians(150.0), radians(45.0), 30, 6);
  const TriMesh other = test::moved(both, {Mat3::Identity(), Vec3(0.0, 2.0, 0.5)});
  const Index n = both.n_vertices(), t = both.n_triangles();
  both.points.conservativeResize(2 * n, 3);
  both.points.bottomRows(n) = other.points;
  both.triangles.conservativeResize(2 * t, 3);
  both.triangles.bottomRows(t) = other.triangles.array() + n;
  io::write_surface(folder_ / "both.ply", both);
  expect_refusal("mesh --surface " + path("both.ply"), "both.vtu", 3,
                 {"both.ply", "intersects itself", "first at (", " mm"});
  const Outcome check = coxa_run("check " + path("both.ply"));
  EXPECT_EQ(check.exit_code, 3);
  EXPECT_TRUE(check.says("both.ply is not usable") && check.says("self-intersection"))
      << check.output;
}
TEST_F(BadInput, C3dWithABrokenParameterSection) {
  const fs::path file = fs::path(COXA_SHARED_DIR) / "data/motion/c3d/bad_parameter_section.c3d";
  if (!fs::exists(file)) GTEST_SKIP() << "needs ../shared/data/motion";
  expect_refusal("track --markers " + file.string(), "motion.csv", 3,
                 {"warning: ", "parameter", "no marker for the role 'asis_right'",
                  "give its label in the marker map", "P1, P2"});
}
TEST_F(BadInput, FileThatIsNoC3d) {
  io::write_bytes(folder_ / "x.c3d", std::string(2000, 'x'));
  expect_refusal("track --markers " + path("x.c3d"), "motion.csv", 3, {"x.c3d", "not a C3D file"});
}
TEST_F(BadInput, MissingMarkers) {
  motion::MarkerData markers;
  markers.labels = {"RASI", "LASI", "SACR"};
  markers.rate = 100.0;
  for (const Vec3& p : {Vec3(120, 0, 900), Vec3(-120, 0, 900), Vec3(0, -150, 920)})
    markers.trajectories.push_back(p.transpose().replicate(20, 1));
  io::write_trc(folder_ / "few.trc", markers);
  expect_refusal("track --markers " + path("few.trc"), "motion.csv", 3,
                 {"no marker for the role", "give its label in the marker map", "RASI"});
}
TEST_F(BadInput, MisspeltKeyOfASubjectFile) {
  io::write_bytes(folder_ / "image.nii.gz", "x");
  io::write_bytes(folder_ / "s.toml",
                  "side = \"left\"\n[image]\npath = \"image.nii.gz\"\n[motion]\n"
                  "pattern = \"flexion\"\nframe = 3\n");
  expect_refusal("run " + path("s.toml"), "result", 3,
                 {"s.toml:6", "frame", "did you mean frames?"});
}

/// A file system of 64 kB mounted at a folder; not there where mounting is not allowed.
class TinyDisk {
 public:
  explicit TinyDisk(const fs::path& folder) : folder_(folder) {
    fs::create_directories(folder_);
    mounted_ = mount("coxa_test", folder_.c_str(), "tmpfs", 0, "size=64k") == 0;
  }
  ~TinyDisk() {
    if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  TinyDisk(const TinyDisk&) = delete;
  TinyDisk& operator=(const TinyDisk&) = delete;
  bool mounted() const { return mounted_; }
  bool empty() const { return fs::is_empty(folder_); }

 private:
  fs::path folder_;
  bool mounted_ = false;
};

TEST_F(BadInput, FullDiskForAFile) {
  const TinyDisk disk(folder_ / "disk");
  if (!disk.mounted()) GTEST_SKIP() << "mounting a small disk is not allowed here";
  io::write_surface(folder_ / "shell.ply", test::lunate_shell());
  const Outcome outcome =
      coxa_run("mesh --quiet --surface " + path("shell.ply") + " --out " + path("disk/shell.vtu"));
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_TRUE(outcome.says("cannot write") && outcome.says("shell.vtu")) << outcome.output;
  EXPECT_TRUE(outcome.says("No space left on device; free some space")) << outcome.output;
  EXPECT_TRUE(disk.empty());
}
TEST_F(BadInput, FullDiskForAStage) {
  SKIP_WITHOUT_ATLAS();
  const TinyDisk disk(folder_ / "disk");
  if (!disk.mounted()) GTEST_SKIP() << "mounting a small disk is not allowed here";
  const Outcome outcome = coxa_run("phantom --quiet --voxel 6 --out " + path("disk/patient"));
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_TRUE(outcome.says("No space left on device")) << outcome.output;
  EXPECT_TRUE(disk.empty());
}
TEST_F(BadInput, FolderThatCannotBeMade) {
  io::write_surface(folder_ / "shell.ply", test::lunate_shell());
  const Outcome outcome =
      coxa_run("mesh --quiet --surface " + path("shell.ply") + " --out /dev/full/shell.vtu");
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_TRUE(outcome.says("cannot make the folder")) << outcome.output;
}

}  // namespace coxa
