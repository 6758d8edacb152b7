// Ctrl-C in every stage: the stage ends with "cancelled" and leaves nothing of its own behind.
#include <coxa/core/error.h>
#include <coxa/io/atlas_file.h>
#include <coxa/pipeline/atlas_stage.h>
#include <coxa/pipeline/joint_stage.h>
#include <coxa/pipeline/measure_stage.h>
#include <coxa/pipeline/mesh_stage.h>
#include <coxa/pipeline/motion_stage.h>
#include <coxa/pipeline/report_stage.h>
#include <coxa/pipeline/segment_stage.h>
#include <coxa/pipeline/subject.h>
#include <coxa/pipeline/virtual_patient.h>
#include <gtest/gtest.h>

#include <functional>

#include "pipeline/small_run.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

const test::SmallRun& run() {
  static const test::SmallRun small("cancel");
  return small;
}
const Subject& subject() {
  static const Subject read = read_subject(run() / "subject.toml");
  return read;
}
JointRequest joint_request() {
  return {.side = Side::right,
          .acetabular_cartilage = run() / "mesh/acetabular_cartilage.vtu",
          .femoral_cartilage = run() / "mesh/femoral_cartilage.vtu",
          .hip_bone = {},
          .femur = {},
          .motion = run() / "motion",
          .joint = {}};
}
fs::path shipped_atlas() { return shipped_data("atlas/hip.coxa-atlas"); }

/// Runs the stage with a monitor that is cancelled at the second report of progress, which comes
/// from within the work; the first says that it begins.
void expect_nothing_after_cancelling(const fs::path& result,
                                     const std::function<void(const Monitor&)>& stage) {
  std::atomic<bool> flag{false};
  int reports = 0;
  Monitor monitor;
  monitor.on_progress = [&](std::string_view, double) { flag = ++reports >= 2; };
  monitor.cancel_flag = &flag;
  try {
    stage(monitor);
    ADD_FAILURE() << "was not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled) << error.what();
  }
  EXPECT_TRUE(flag.load()) << "reported no progress";
  EXPECT_FALSE(fs::exists(result));
  for (const auto& entry : fs::directory_iterator(result.parent_path()))
    EXPECT_EQ(entry.path().string().find(".partial"), std::string::npos) << entry.path();
}

}  // namespace

TEST(Cancelled, SegmentLeavesNothing) {
  if (!fs::exists(shipped_atlas())) GTEST_SKIP() << "no shipped atlas";
  io::write_landmarks(run() / "places.mrk.json", io::read_atlas(shipped_atlas()).landmarks);
  SegmentRequest request{.images = {{run() / "image.nii.gz", {}}},
                         .side = Side::right,
                         .landmarks = run() / "places.mrk.json",
                         .atlas = shipped_atlas(),
                         .options = {}};
  request.options.contrast = "t1";
  const fs::path out = run() / "cancelled_segment";
  expect_nothing_after_cancelling(
      out, [&](const Monitor& monitor) { run_segment_stage(request, out, Reuse::never, monitor); });
}
TEST(Cancelled, MeshLeavesNothing) {
  const fs::path out = run() / "cancelled_mesh";
  expect_nothing_after_cancelling(out, [&](const Monitor& monitor) {
    run_mesh_stage(run() / "segment", {}, out, Reuse::never, monitor);
  });
}
TEST(Cancelled, MeshOfOneFileLeavesNothing) {
  const fs::path out = run() / "cancelled.vtu";
  const MeshRequest request{run() / "segment/femoral_cartilage.vtp", {}, {}};
  expect_nothing_after_cancelling(
      out, [&](const Monitor& monitor) { run_mesh_file(request, out, monitor); });
}
TEST(Cancelled, MotionLeavesNothing) {
  const fs::path out = run() / "cancelled_motion";
  expect_nothing_after_cancelling(out, [&](const Monitor& monitor) {
    run_motion_stage(subject(), run() / "segment", out, Reuse::never, monitor);
  });
}
TEST(Cancelled, JointLeavesNothing) {
  run_motion_stage(subject(), run() / "segment", run() / "motion", Reuse::if_unchanged, {});
  const fs::path out = run() / "cancelled_joint";
  expect_nothing_after_cancelling(out, [&](const Monitor& monitor) {
    run_joint_stage(joint_request(), out, Reuse::never, monitor);
  });
}
TEST(Cancelled, ReportLeavesNothing) {
  run_motion_stage(subject(), run() / "segment", run() / "motion", Reuse::if_unchanged, {});
  run_joint_stage(joint_request(), run() / "joint", Reuse::if_unchanged, {});
  const fs::path out = run() / "report";
  expect_nothing_after_cancelling(out, [&](const Monitor& monitor) {
    run_report_stage(subject(), run() / "", out, Reuse::never, monitor);
  });
}
TEST(Cancelled, MeasureAndRomLeaveNothing) {
  expect_nothing_after_cancelling(run() / "measure", [&](const Monitor& monitor) {
    run_measure_stage(run() / "", {}, Reuse::never, monitor);
  });
  expect_nothing_after_cancelling(run() / "rom", [&](const Monitor& monitor) {
    run_rom_stage(run() / "", {}, Reuse::never, monitor);
  });
}
TEST(Cancelled, PhantomLeavesNothing) {
  if (!fs::exists(shipped_atlas())) GTEST_SKIP() << "no shipped atlas";
  VirtualPatientRequest request;
  request.atlas = shipped_atlas();
  request.image.voxel = Vec3::Constant(4.0);
  const fs::path out = run() / "cancelled_phantom";
  expect_nothing_after_cancelling(
      out, [&](const Monitor& monitor) { make_virtual_patient(request, out, monitor); });
}
TEST(Cancelled, AtlasBuildLeavesNothing) {
  const fs::path data = fs::path(COXA_SHARED_DIR) / "data";
  if (!fs::exists(data / "libhip")) GTEST_SKIP() << "needs " << data;
  AtlasRequest request;
  request.data = data;
  const fs::path out = run() / "cancelled.coxa-atlas";
  expect_nothing_after_cancelling(
      out, [&](const Monitor& monitor) { build_atlas_file(request, out, monitor); });
}

}  // namespace coxa::pipeline
