#include <coxa/io/dicom.h>

#include <coxa/io/volumes.h>

#include "io/dicom_writer.h"
#include "io/test_files.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace coxa::io {
namespace {

const std::filesystem::path kMri = COXA_SHARED_DIR "/data/mri";

/// Slices 4 mm apart along +z; the names run against the positions.
std::vector<TestSlice> stack(int n) {
  std::vector<TestSlice> slices(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    TestSlice& slice = slices[static_cast<std::size_t>(k)];
    slice.position = Vec3(-10, 20, 100 + 4 * k);
    for (auto& pixel : slice.pixels) pixel = static_cast<std::int16_t>(pixel + 10 * k);
  }
  return slices;
}

void write_all(const TestFolder& folder, const std::vector<TestSlice>& slices,
               const std::string& prefix = "s") {
  for (std::size_t k = 0; k < slices.size(); ++k) {
    write_dicom(folder / (prefix + std::to_string(slices.size() - k) + ".dcm"), slices[k]);
  }
}

std::string refusal(const TestFolder& folder) {
  return error_text(ErrorCode::bad_input, [&] { read_volume(folder.path()); });
}

TEST(Dicom, StackIsSortedByPositionAndPlacedInLps) {
  const TestFolder folder;
  write_all(folder, stack(5));
  const Volume volume = read_volume(folder.path());
  EXPECT_EQ(volume.size, (std::array<Index, 3>{3, 2, 5}));
  EXPECT_LT((volume.spacing - Vec3(0.5, 0.75, 4.0)).norm(), 1e-9);
  EXPECT_LT((volume.position(Vec3(2, 1, 3)) - Vec3(-9, 20.75, 112)).norm(), 1e-9);
  EXPECT_EQ(volume.values[static_cast<std::size_t>(volume.offset(2, 1, 3))], 36.0F);
}
TEST(Dicom, ObliqueStackKeepsItsFrameAndSlopeIsApplied) {
  const TestFolder folder;
  const Mat3 R =
      (Eigen::AngleAxisd(0.4, Vec3::UnitX()) * Eigen::AngleAxisd(0.3, Vec3::UnitY())).matrix();
  std::vector<TestSlice> slices = stack(4);
  for (int k = 0; k < 4; ++k) {
    TestSlice& slice = slices[static_cast<std::size_t>(k)];
    slice.position = R * Vec3(1, 2, -3.0 * k);  // against the normal
    slice.row = R.col(0);
    slice.column = R.col(1);
    slice.slope = 0.5;
  }
  write_all(folder, slices);
  const Volume volume = read_volume(folder.path());
  EXPECT_LT((volume.direction - R).norm(), 1e-5);  // six decimals in the header
  EXPECT_LT((volume.origin - R * Vec3(1, 2, -9)).norm(), 1e-5);
  EXPECT_EQ(volume.values[0], 0.5F * 31.0F);
}
TEST(Dicom, StructureSetsAndOtherFilesAmongTheSlicesArePassedOver) {
  const TestFolder folder;
  write_all(folder, stack(4));
  TestSlice structure;
  structure.has_pixels = false;
  write_dicom(folder / "rtstruct.dcm", structure);
  write_bytes(folder / "notes.txt", "not DICOM");
  EXPECT_EQ(read_volume(folder.path()).size[2], 4);
}
TEST(Dicom, TwoSeriesAreNamedAndOneCanBeSelected) {
  const TestFolder folder;
  write_all(folder, stack(4));
  std::vector<TestSlice> second = stack(6);
  for (TestSlice& slice : second) {
    slice.series_uid = "1.2.3.5";
    slice.series_number = "12";
    slice.description = "t2 coronal";
  }
  write_all(folder, second, "other");
  const std::string text = refusal(folder);
  for (const char* part :
       {"2 series", "series 3 't1 axial'", "series 12 't2 coronal'", "6 slices"}) {
    EXPECT_TRUE(contains(text, part)) << text;
  }
  EXPECT_EQ(read_volume(folder.path(), {.series = "12"}).size[2], 6);
  EXPECT_EQ(read_volume(folder.path(), {.series = "1.2.3.4"}).size[2], 4);
  const auto wrong = [&] { read_volume(folder.path(), {.series = "7"}); };
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, wrong), "no series 7"));
}
TEST(Dicom, MissingSliceIsReportedWithTheGap) {
  const TestFolder folder;
  std::vector<TestSlice> slices = stack(8);
  slices.erase(slices.begin() + 3);
  write_all(folder, slices);
  const std::string text = refusal(folder);
  EXPECT_TRUE(contains(text, "missing") && contains(text, "a gap of 8 mm where 4 mm is usual"))
      << text;
}
TEST(Dicom, DuplicatedSliceIsRefused) {
  const TestFolder folder;
  std::vector<TestSlice> slices = stack(6);
  slices.push_back(slices[2]);
  write_all(folder, slices);
  EXPECT_TRUE(contains(refusal(folder), "twice"));
}
/// Writes a stack whose third slice (of four) has only its first `bytes` bytes.
void write_cut_stack(const TestFolder& folder, std::size_t bytes) {
  write_all(folder, stack(4));
  write_bytes(folder / "s2.dcm", dicom_bytes(stack(4)[2]).substr(0, bytes));
}
TEST(Dicom, SliceCutShortWithinItsPixelsIsNamed) {
  const TestFolder folder;
  write_cut_stack(folder, dicom_bytes(stack(4)[2]).size() - 5);
  const std::string text = refusal(folder);
  EXPECT_TRUE(contains(text, "s2.dcm is cut short: its pixels take 12 bytes and 7 are there"))
      << text;
  EXPECT_TRUE(contains(text, "export that series again")) << text;
}
TEST(Dicom, SliceCutShortAnywhereIsAnErrorAndNeverACrash) {
  const TestFolder folder;
  write_all(folder, stack(4));
  const std::string whole_slice = dicom_bytes(stack(4)[2]);
  const std::size_t whole = whole_slice.size();
  for (std::size_t bytes = 0; bytes < whole; bytes += bytes < whole - 40 ? 7 : 1) {
    write_bytes(folder / "s2.dcm", whole_slice.substr(0, bytes));
    EXPECT_THROW(read_volume(folder.path()), Error) << bytes << " of " << whole;
  }
}
TEST(Dicom, SliceWithFewerPixelsThanItsSizeNeedsIsNamed) {
  const TestFolder folder;
  std::vector<TestSlice> slices = stack(5);
  slices[1].pixels.pop_back();
  write_all(folder, slices);
  EXPECT_TRUE(contains(refusal(folder), "too few pixels: 10 bytes where its size needs 12"));
}
TEST(Dicom, LocalizerIsRefused) {
  const TestFolder folder;
  std::vector<TestSlice> slices = stack(6);
  slices[5].row = Vec3::UnitY();
  slices[5].column = -Vec3::UnitZ();
  write_all(folder, slices);
  EXPECT_TRUE(contains(refusal(folder), "mixed orientations"));
}
TEST(Dicom, ThinSlicesFarApartAreALocalizer) {
  const TestFolder folder;
  std::vector<TestSlice> slices = stack(6);
  for (TestSlice& slice : slices) slice.thickness = 1.0;
  write_all(folder, slices);
  EXPECT_TRUE(contains(refusal(folder), "a localizer"));
}
TEST(Dicom, OtherStacksThatAreNotOneGridAreRefused) {
  const auto reason = [](auto change) {
    const TestFolder folder;
    std::vector<TestSlice> slices = stack(6);
    change(slices);
    write_all(folder, slices);
    return refusal(folder);
  };
  EXPECT_TRUE(contains(reason([](auto& s) { s.resize(2); }), "only 2 slices"));
  EXPECT_TRUE(contains(reason([](auto& s) { s[3].position[2] += 0.5; }), "uneven steps"));
  EXPECT_TRUE(contains(reason([](auto& s) {
                         for (std::size_t k = 0; k < s.size(); ++k)
                           s[k].position[0] += 0.5 * static_cast<double>(k);
                       }),
                       "sheared"));
  EXPECT_TRUE(contains(reason([](auto& s) { s[2].row_spacing = 0.8; }), "different size"));
  EXPECT_TRUE(contains(reason([](auto& s) {
                         s[0].frames = 2;
                         s[0].pixels.resize(12);
                       }),
                       "multi-frame"));
  EXPECT_TRUE(contains(reason([](auto& s) {
                         for (auto& slice : s) {
                           slice.samples_per_pixel = 3;
                           slice.pixels.resize(9);
                         }
                       }),
                       "colour"));
}
TEST(Dicom, EchoesOfOneSeriesAreStacksOfTheirOwn) {
  const TestFolder folder;
  write_all(folder, stack(4));
  std::vector<TestSlice> second = stack(4);
  for (TestSlice& slice : second) slice.echo = "2";
  write_all(folder, second, "echo");
  EXPECT_TRUE(contains(refusal(folder), "series 3-echo2"));
  EXPECT_EQ(read_volume(folder.path(), {.series = "3-echo1"}).size[2], 4);
}
TEST(Dicom, EmptyFolderIsNamed) {
  const TestFolder empty;
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_file, [&] { read_volume(empty.path()); }),
                       "no DICOM image"));
}
TEST(Dicom, SeriesThatHoldThePointsAreFound) {
  const TestFolder folder;
  write_all(folder, stack(5));
  std::vector<TestSlice> second = stack(5);
  for (TestSlice& slice : second) {
    slice.series_uid = "1.2.3.5";
    slice.series_number = "4";
    slice.position[2] -= 50.0;
  }
  write_all(folder, second, "low");
  Points points(1, 3);
  points << -9.5, 20.5, 60.0;
  const auto holding = series_holding(list_dicom_series(folder.path()), points);
  ASSERT_EQ(holding.size(), 1U);
  EXPECT_EQ(holding[0].id, "4");
}

TEST(RealDicom, FolderOfOnePatientListsItsSixStacks) {
  if (!std::filesystem::exists(kMri)) GTEST_SKIP() << "needs " << kMri;
  const auto series = list_dicom_series(kMri / "one_patient/dicom");
  std::string usable;
  for (const DicomSeries& one : series) {
    if (one.usable()) usable += one.id + " ";
  }
  EXPECT_EQ(usable, "6 7 8 ");
  const auto pelvis =
      std::find_if(series.begin(), series.end(), [](const auto& s) { return s.id == "6"; });
  EXPECT_NEAR(pelvis->grid.spacing[2], 8.0, 1e-3);
  EXPECT_EQ(read_series(*pelvis).size, (std::array<Index, 3>{512, 432, 17}));
}
TEST(RealDicom, TiltedStackWithStructureSetIsRead) {
  if (!std::filesystem::exists(kMri)) GTEST_SKIP() << "needs " << kMri;
  const Volume volume = read_volume(kMri / "sts003_dicom");
  EXPECT_EQ(volume.size, (std::array<Index, 3>{512, 512, 36}));
  EXPECT_LT((volume.spacing - Vec3(0.7813, 0.7813, 7.0)).norm(), 1e-3);
  // first slice in the folder is the highest
  EXPECT_LT((volume.position(Vec3(0, 0, 35)) - Vec3(-207.373, -187.556, 99.9427)).norm(), 0.02);
}
TEST(RealDicom, ObliqueSeriesAreReadAndTheLocalizerRefused) {
  if (!std::filesystem::exists(kMri)) GTEST_SKIP() << "needs " << kMri;
  const auto folder = kMri / "prostatex0001_dicom";
  EXPECT_EQ(list_dicom_series(folder).size(), 3U);
  EXPECT_LT(std::abs(read_volume(folder, {.series = "6"}).spacing[2] - 3.0), 1e-3);
  EXPECT_NEAR(read_volume(folder, {.series = "5"}).direction(2, 1), -0.994, 1e-3);
  const auto localizer = [&] { read_volume(folder, {.series = "1"}); };
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_input, localizer), "mixed orientations"));
}

}  // namespace
}  // namespace coxa::io
