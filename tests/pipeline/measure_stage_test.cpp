#include <coxa/pipeline/measure_stage.h>

#include <coxa/core/error.h>
#include <coxa/pipeline/reference_ranges.h>
#include <coxa/pipeline/subject.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/small_run.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

double number(const Record& record, const std::string& key) {
  const auto found = record.figures.find(key);
  return found == record.figures.end() ? kNaN : std::get<double>(found->second);
}

}  // namespace

TEST(MeasureStage, LeavesThicknessShapeAndItsRecord) {
  const test::SmallRun run("measure");
  const Record record = run_measure_stage(run / "", {}, Reuse::if_unchanged, {});
  for (const char* file :
       {"measure.json", "morphometry.csv", "thickness.csv", "femur.vtp", "hip_bone.vtp"})
    EXPECT_TRUE(fs::exists(run / "measure" / file)) << file;
  EXPECT_EQ(std::get<std::string>(record.figures.at("side")), "right");
  EXPECT_NEAR(number(record, "head_radius_mm"), test::kHeadRadius, 0.1);
  // both layers are 1.5 mm thick; the socket opens straight down
  EXPECT_NEAR(number(record, "femoral_cartilage_thickness_median_mm"), 1.5, 0.05);
  EXPECT_NEAR(number(record, "acetabular_cartilage_thickness_median_mm"), 1.5, 0.05);
  EXPECT_NEAR(number(record, "acetabular_inclination_deg"), 0.0, 0.5);
  EXPECT_NEAR(number(record, "lateral_centre_edge_angle_deg"), degrees(test::kSocketAngle), 2.0);
  EXPECT_GT(number(record, "lateral_centre_edge_angle_deg_interval"), 1.0);
  EXPECT_EQ(std::get<std::string>(record.figures.at("lateral_centre_edge_angle_deg_judgement"))
                .substr(0, 9),
            "above 40:");
  const Surface femur = io::read_surface_with_fields(run / "measure" / "femur.vtp");
  EXPECT_EQ(femur.fields.count("cartilage_thickness_mm"), 1u);
}
TEST(MeasureStage, SaysWhereTheFramesComeFrom) {
  const test::SmallRun run("measure_frames");
  const Record record = run_measure_stage(run / "segment", {}, Reuse::never, {});
  ASSERT_FALSE(record.warnings.empty());
  EXPECT_NE(record.warnings.front().find("image"), std::string::npos);
  EXPECT_TRUE(fs::exists(run / "segment" / "measure" / "measure.json"));
}
TEST(MeasureStage, BareBoneBeyondTheLargestThicknessIsNotCounted) {
  const test::SmallRun run("measure_bare");
  const Record record = run_measure_stage(run / "", {.max_thickness = 1.0}, Reuse::never, {});
  EXPECT_EQ(number(record, "femoral_cartilage_covered_area_mm2"), 0.0);
}
TEST(MeasureStage, WantsASegmentation) {
  const test::SmallRun run("measure_nothing");
  fs::remove(run / "segment" / "segment.json");
  try {
    run_measure_stage(run / "", {}, Reuse::never, {});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_file);
    EXPECT_NE(std::string(error.what()).find("run coxa segment"), std::string::npos);
  }
  EXPECT_FALSE(fs::exists(run / "measure"));
}
TEST(RomStage, LeavesTheFourExaminationsAndItsRecord) {
  const test::SmallRun run("rom");
  const Record record = run_rom_stage(run / "", {.step = radians(2.0)}, Reuse::if_unchanged, {});
  EXPECT_TRUE(fs::exists(run / "rom" / "rom.csv"));
  EXPECT_TRUE(fs::exists(run / "rom" / "rom.json"));
  // the neck meets the rim before 90 degrees: what follows is blocked
  EXPECT_NEAR(number(record, "flexion_deg"), 86.0, 3.0);
  EXPECT_EQ(std::get<std::string>(record.figures.at("flexion_end")), "bones touch");
  EXPECT_EQ(std::get<std::string>(record.figures.at("fadir_end")),
            "bones touch on the way to the start");
  EXPECT_EQ(number(record, "fadir_deg"), 0.0);
  for (const char* name : {"internal_rotation_at_90_flexion_deg", "faber_deg", "interval_deg"})
    EXPECT_EQ(record.figures.count(name), 1u) << name;
  const std::string csv = io::read_bytes(run / "rom" / "rom.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
}
TEST(ReferenceRanges, AreOfMeasuresThatThereAreAndNameTheirSource) {
  const test::SmallRun run("ranges");
  const Record measured = run_measure_stage(run / "", {}, Reuse::never, {});
  const Record moved = run_rom_stage(run / "", {.step = radians(5.0)}, Reuse::never, {});
  for (const auto& [name, range] : read_reference_ranges(shipped_data("reference_ranges.toml"))) {
    EXPECT_EQ(measured.figures.count(name) + moved.figures.count(name), 1u) << name;
    EXPECT_FALSE(range.source.empty()) << name;
  }
}
TEST(ReferenceRanges, JudgeAValueAndItsInterval) {
  const ReferenceRange range{.low = 25, .high = 40, .below = "less", .above = "more"};
  EXPECT_EQ(judged(30.0, range), "within 25 to 40");
  EXPECT_EQ(judged(20.0, range), "below 25: less");
  EXPECT_EQ(judged(41.0, range, 3.0),
            "above 40: more; uncertain, the limit lies within the interval");
  EXPECT_EQ(judged(kNaN, range), "");
  EXPECT_EQ(judged(50.0, {.high = 55}), "not above 55");
  EXPECT_EQ(judged(50.0, {.low = 45}), "not below 45");
}
TEST(ReferenceRanges, NameTheLineOfAMissingSource) {
  const test::SmallRun run("ranges_broken");
  io::write_bytes(run / "r.toml", "[[range]]\nmeasure = \"x_deg\"\nlow = 1.0\nbelow = \"b\"\n");
  EXPECT_THROW(read_reference_ranges(run / "r.toml"), Error);
  io::write_bytes(run / "r.toml",
                  "[[range]]\nmeasure = \"x\"\nlow = 3\nhigh = 1\nbelow = \"b\"\nabove = \"a\"\n"
                  "source = \"s\"\n");
  EXPECT_THROW(read_reference_ranges(run / "r.toml"), Error);
}

}  // namespace coxa::pipeline
