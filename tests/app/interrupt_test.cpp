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
TEST_F(Interrupted, RunKeepsFinishedStagesAndNoHalfOne) {
  std::string subject =
      "side = \"right\"\n[motion]\npattern = \"flexion\"\nframes = 2\n[surfaces]\n";
  for (const char* name : {"femur", "hip_bone", "femoral_cartilage", "acetabular_cartilage"})
    subject += std::string(name) + " = \"segment/" + name + ".vtp\"\n";
  io::write_bytes(run_ / "subject.toml", subject);
  std::vector<std::string> finished;
  for (const std::string stage : {"segment", "mesh", "motion", "joint", "report"}) {
    const test::Outcome outcome = test::coxa_interrupted(
        {"run", (run_ / "subject.toml").string(), "--resume", "--out", path("whole")},
        "\"stage\":\"" + stage + "\"");
    EXPECT_EQ(outcome.exit_code, 130) << outcome.output;
    EXPECT_FALSE(fs::exists(folder_ / "whole" / stage)) << outcome.output;
    EXPECT_FALSE(fs::exists(folder_ / "whole" / (stage + ".partial")));
    for (const std::string& done : finished)
      EXPECT_TRUE(fs::exists(folder_ / "whole" / done / (done + ".json"))) << done;
    finished.push_back(stage);
  }
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
