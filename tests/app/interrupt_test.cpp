// Ctrl-C as a user presses it: exit code 130, nothing of the interrupted verb is left.
#include <coxa/io/atlas_file.h>
#include <coxa/io/landmarks.h>
#include <coxa/pipeline/motion_stage.h>
#include <coxa/pipeline/subject.h>

#include "app/command.h"
#include "pipeline/small_run.h"

namespace coxa {
namespace fs = std::filesystem;

class Interrupted : public test::CommandTest {
 protected:
  Interrupted() : run_("interrupt") {}

  void expect_nothing_left(std::vector<std::string> arguments, const std::string& out) {
    arguments.push_back("--out");
    arguments.push_back(path(out));
    const test::Outcome outcome = test::coxa_interrupted(arguments);
    EXPECT_EQ(outcome.exit_code, 130) << outcome.output;
    EXPECT_TRUE(outcome.says("\"code\":\"cancelled\"")) << outcome.output;
    EXPECT_TRUE(nothing_at(out)) << outcome.output;
  }
  static bool has_atlas() { return fs::exists(pipeline::shipped_data("atlas/hip.coxa-atlas")); }
  test::SmallRun run_;
};

TEST_F(Interrupted, SegmentLeavesNothing) {
  if (!has_atlas()) GTEST_SKIP() << "no shipped atlas";
  const auto atlas = io::read_atlas(pipeline::shipped_data("atlas/hip.coxa-atlas"));
  io::write_landmarks(folder_ / "places.mrk.json", atlas.landmarks);
  expect_nothing_left({"segment", "--image", (run_ / "image.nii.gz").string(), "--side", "right",
                       "--contrast", "t1", "--landmarks", path("places.mrk.json")},
                      "segment");
}
TEST_F(Interrupted, RunKeepsNoHalfStage) {
  if (!has_atlas()) GTEST_SKIP() << "no shipped atlas";
  const auto atlas = io::read_atlas(pipeline::shipped_data("atlas/hip.coxa-atlas"));
  io::write_landmarks(run_ / "places.mrk.json", atlas.landmarks);
  io::write_bytes(run_ / "subject.toml", io::read_bytes(run_ / "subject.toml") +
                                             "[landmarks]\npath = \"places.mrk.json\"\n");
  const test::Outcome outcome =
      test::coxa_interrupted({"run", (run_ / "subject.toml").string(), "--out", path("whole")});
  EXPECT_EQ(outcome.exit_code, 130) << outcome.output;
  EXPECT_FALSE(fs::exists(folder_ / "whole" / "segment"));
  EXPECT_FALSE(fs::exists(folder_ / "whole" / "segment.partial"));
}
TEST_F(Interrupted, MeshLeavesNothing) {
  expect_nothing_left({"mesh", "--surface", (run_ / "segment/femoral_cartilage.vtp").string()},
                      "mesh.vtu");
}
TEST_F(Interrupted, SimulateLeavesNothing) {
  const auto subject = pipeline::read_subject(run_ / "subject.toml");
  pipeline::run_motion_stage(subject, run_ / "segment", run_ / "motion", pipeline::Reuse::never,
                             {});
  io::write_bytes(run_ / "joint.toml",
                  "side = \"right\"\nmotion = \"motion\"\n"
                  "acetabular_cartilage = \"mesh/acetabular_cartilage.vtu\"\n"
                  "femoral_cartilage = \"mesh/femoral_cartilage.vtu\"\n");
  expect_nothing_left({"simulate", (run_ / "joint.toml").string()}, "joint");
}
TEST_F(Interrupted, PhantomLeavesNothing) {
  if (!has_atlas()) GTEST_SKIP() << "no shipped atlas";
  expect_nothing_left({"phantom", "--voxel", "3"}, "phantom");
}
TEST_F(Interrupted, AtlasBuildLeavesNothing) {
  const fs::path data = fs::path(COXA_SHARED_DIR) / "data";
  if (!fs::exists(data / "libhip")) GTEST_SKIP() << "needs " << data;
  expect_nothing_left({"atlas", "build", "--data", data.string()}, "own.coxa-atlas");
}

}  // namespace coxa
