#include <coxa/io/volumes.h>

#include <coxa/core/rng.h>
#include <coxa/io/files.h>

#include "io/test_files.h"

#include <Eigen/Geometry>

#include <cstring>

namespace coxa::io {
namespace {

const std::filesystem::path kShared = COXA_SHARED_DIR "/data";

Volume oblique_volume() {
  Volume volume;
  volume.size = {5, 4, 3};
  volume.spacing = Vec3(0.8, 1.25, 3.0);
  volume.origin = Vec3(-40.5, 12.25, 700.0);
  volume.direction =
      (Eigen::AngleAxisd(0.3, Vec3::UnitX()) * Eigen::AngleAxisd(-2.2, Vec3::UnitZ())).matrix();
  Rng rng(1);
  for (int i = 0; i < 60; ++i) volume.values.push_back(static_cast<float>(100.0 * rng.normal()));
  return volume;
}

void expect_same(const Volume& a, const Volume& b, double placement, float value) {
  ASSERT_EQ(a.size, b.size);
  EXPECT_LT((a.spacing - b.spacing).norm(), placement);
  EXPECT_LT((a.direction - b.direction).norm(), placement);
  EXPECT_LT((a.origin - b.origin).norm(), 100 * placement);
  for (std::size_t i = 0; i < a.values.size(); ++i) EXPECT_NEAR(a.values[i], b.values[i], value);
}

TEST(Volumes, ComeBackFromEveryFormat) {
  const TestFolder folder;
  const Volume volume = oblique_volume();
  for (const char* name : {"a.nii", "a.nii.gz", "a.nrrd"}) {
    SCOPED_TRACE(name);
    write_volume(folder / name, volume);
    expect_same(read_volume(folder / name), volume, 1e-6, 0.0F);  // NIfTI keeps 32-bit placement
    write_volume(folder / name, volume, VoxelType::int16);
    expect_same(read_volume(folder / name), volume, 1e-6, 0.5F);
  }
}
TEST(Volumes, MirroredGridComesBackFromNifti) {
  const TestFolder folder;
  Volume volume = oblique_volume();
  volume.direction.col(2) *= -1.0;
  write_volume(folder / "a.nii", volume);
  expect_same(read_volume(folder / "a.nii"), volume, 1e-6, 0.0F);
  // the qform alone says the same: switch the sform off
  std::string bytes = read_bytes(folder / "a.nii");
  const std::int16_t off = 0;
  std::memcpy(bytes.data() + 254, &off, sizeof(off));
  write_bytes(folder / "q.nii", bytes);
  expect_same(read_volume(folder / "q.nii"), volume, 1e-6, 0.0F);
}
TEST(Volumes, SameVolumeGivesTheSameBytes) {
  const TestFolder folder;
  write_volume(folder / "a.nii.gz", oblique_volume());
  write_volume(folder / "b.nii.gz", oblique_volume());
  EXPECT_EQ(read_bytes(folder / "a.nii.gz"), read_bytes(folder / "b.nii.gz"));
}
TEST(Volumes, MetaImageIsReadWithItsAxesAndByteOrder) {
  const TestFolder folder;
  std::string bytes =
      "ObjectType = Image\nNDims = 3\nBinaryDataByteOrderMSB = True\nTransformMatrix = 0 1 0 -1 0 "
      "0 0 0 1\n"
      "Offset = 10 20 30\nElementSpacing = 1 2 3\nDimSize = 2 2 2\nElementType = MET_SHORT\n"
      "ElementDataFile = LOCAL\n";
  for (int i = 0; i < 8; ++i) bytes += {'\1', static_cast<char>(i)};
  write_bytes(folder / "a.mha", bytes);
  const Volume volume = read_volume(folder / "a.mha");
  EXPECT_EQ(volume.values[3], 256 + 3);
  EXPECT_LT((volume.position(Vec3(1, 1, 1)) - Vec3(8, 21, 33)).norm(), 1e-12);
}
TEST(Volumes, NrrdInRasIsTurnedToLps) {
  const TestFolder folder;
  std::string bytes =
      "NRRD0004\ntype: unsigned char\ndimension: 3\nspace: right-anterior-superior\nsizes: 1 1 2\n"
      "space directions: (1,0,0) (0,2,0) (0,0,3)\nencoding: raw\nspace origin: (5,6,7)\n\nAB";
  write_bytes(folder / "a.nrrd", bytes);
  const Volume volume = read_volume(folder / "a.nrrd");
  EXPECT_LT((volume.position(Vec3(1, 1, 1)) - Vec3(-6, -8, 10)).norm(), 1e-12);
  EXPECT_EQ(volume.values[1], 'B');
}
TEST(Volumes, ValuesOutsideTheStoredTypeAreRefused) {
  const TestFolder folder;
  Volume volume = oblique_volume();
  volume.values[7] = 4e4F;
  const auto write = [&] { write_volume(folder / "a.nii", volume, VoxelType::int16); };
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, write), "40000"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}
TEST(Volumes, BrokenFilesAreNamed) {
  const TestFolder folder;
  write_volume(folder / "a.nii.gz", oblique_volume());
  const std::string whole = read_bytes(folder / "a.nii.gz");
  write_bytes(folder / "cut.nii.gz", whole.substr(0, whole.size() / 2));
  write_bytes(folder / "text.nii", "this is not an image");
  write_volume(folder / "b.nii", oblique_volume());
  write_bytes(folder / "short.nii", read_bytes(folder / "b.nii").substr(0, 400));
  write_bytes(folder / "cut.nrrd", "NRRD0004\ntype: float\n");
  for (const char* name : {"cut.nii.gz", "text.nii", "short.nii", "cut.nrrd", "absent.nii"}) {
    const auto read = [&] { read_volume(folder / name); };
    EXPECT_TRUE(contains(error_text(ErrorCode::bad_file, read), name)) << name;
  }
  const auto unknown = [&] { read_volume(folder / "a.jpg"); };
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, unknown), ".nii.gz"));
}
TEST(Volumes, ShearedGridIsRefused) {
  const TestFolder folder;
  write_volume(folder / "a.nii", oblique_volume());
  std::string bytes = read_bytes(folder / "a.nii");
  const float shear = 5.0F;
  std::memcpy(bytes.data() + 284, &shear, sizeof(shear));  // srow_x[1]
  write_bytes(folder / "a.nii", bytes);
  const auto read = [&] { read_volume(folder / "a.nii"); };
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, read), "not orthogonal"));
}
TEST(Volumes, RealImageWithoutSformIsPlacedByItsQform) {
  const auto path = kShared / "mri/sts044/t1.nii.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs " << path;
  const Volume image = read_volume(path),
               bones = read_volume(kShared / "mri/sts044/bones_from_ct.nii.gz");
  ASSERT_EQ(image.size, bones.size);
  EXPECT_LT((image.origin - bones.origin).norm(), 0.01);
  EXPECT_LT((image.direction - bones.direction).norm(), 1e-4);
  EXPECT_TRUE(in_view(image, Vec3(-87.1, 22.7, -740.8), 10.0));
  EXPECT_EQ(sample(bones, Vec3(-87.1, 22.7, -740.8)), 1.0);  // centre of the femoral head
}
TEST(Volumes, PhantomHoldsTheHeadCentreOfItsDescription) {
  const auto path = kShared / "phantom/m5_right_t1_oblique.nii.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs " << path;
  const Volume image = read_volume(path);
  EXPECT_LT((image.spacing - Vec3(0.7, 0.7, 2.0)).norm(), 1e-5);
  EXPECT_TRUE(in_view(image, Vec3(-112.490, 4.988, -369.893), 30.0));
}

}  // namespace
}  // namespace coxa::io
