#include <coxa/io/labels.h>

#include <coxa/io/files.h>
#include <coxa/io/volumes.h>

#include "io/test_files.h"

namespace coxa::io {
namespace {

LabelMap two_bones() {
  LabelMap map;
  map.volume.size = {3, 2, 2};
  map.volume.spacing = Vec3(1, 2, 3);
  map.volume.values = {0, 1, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0};
  map.labels = {{.value = 1, .name = "femur", .colour = {0.9, 0.8, 0.7}},
                {.value = 2, .name = "hip_bone", .colour = {0.1, 0.25, 0.5}}};
  return map;
}

TEST(Labels, ComeBackWithNamesAndColours) {
  const TestFolder folder;
  for (const char* name : {"a.nii.gz", "b.seg.nrrd"}) {
    SCOPED_TRACE(name);
    write_labels(folder / name, two_bones());
    const LabelMap map = read_labels(folder / name);
    EXPECT_EQ(map.volume.values, two_bones().volume.values);
    ASSERT_EQ(map.labels.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(map.labels[i].value, two_bones().labels[i].value);
      EXPECT_EQ(map.labels[i].name, two_bones().labels[i].name);
      EXPECT_EQ(map.labels[i].colour, two_bones().labels[i].colour);
    }
  }
}
TEST(Labels, SegmentationCarriesTheExtentThatSlicerReads) {
  const TestFolder folder;
  write_labels(folder / "a.seg.nrrd", two_bones());
  const std::string header = read_bytes(folder / "a.seg.nrrd").substr(0, 2000);
  EXPECT_TRUE(contains(header, "Segment0_Extent:=1 2 0 0 0 0\n"));
  EXPECT_TRUE(contains(header, "Segment1_Extent:=0 1 0 1 1 1\n"));
}
TEST(Labels, PlainNamesAreReadAndMissingOnesMadeUp) {
  const TestFolder folder;
  write_volume(folder / "a.nii", two_bones().volume, VoxelType::uint8);
  EXPECT_EQ(read_labels(folder / "a.nii").labels.at(1).name, "label_2");
  write_bytes(folder / "a.json", R"({"2": "hip_bone", "1": "femur"})");
  EXPECT_EQ(read_labels(folder / "a.nii").labels.at(0).name, "femur");
}
TEST(Labels, BadMapsAreRefused) {
  const TestFolder folder;
  LabelMap map = two_bones();
  const auto write = [&] { write_labels(folder / "a.nii", map); };
  map.volume.values[0] = 0.5F;
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, write), "0.5"));
  map.volume.values[0] = 3.0F;
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, write), "value 3"));
  map.volume.values[0] = 0.0F;
  map.labels[0].value = 300;
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, write), "300"));
  const auto other = [&] { write_labels(folder / "a.mha", two_bones()); };
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, other), ".seg.nrrd"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));

  write_labels(folder / "a.nii", two_bones());
  const auto read = [&] { read_labels(folder / "a.nii"); };
  write_bytes(folder / "a.json", "{\"1\": ");
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_file, read), "a.json"));
  write_bytes(folder / "a.json", R"({"femur": 1})");
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_file, read), "a.json"));
}

}  // namespace
}  // namespace coxa::io
