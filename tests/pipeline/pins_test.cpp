#include <coxa/core/error.h>
#include <coxa/pipeline/segment_stage.h>
#include <gtest/gtest.h>

#include "pipeline/small_run.h"

namespace coxa::pipeline {

TEST(SegmentStage, SaysHowPinsAreNamedBeforeItSearches) {
  const test::SmallRun run("pins");
  io::write_landmarks(run / "pins.mrk.json", {{"femur", Vec3(1, 2, 3)}});
  SegmentRequest request;
  request.images = {{run / "image.nii.gz", {}}};
  request.atlas = run / "subject.toml";  // not read as far as this goes
  request.pins = run / "pins.mrk.json";
  try {
    run_segment_stage(request, run / "pinned", Reuse::never, {});
    FAIL() << "took a pin without a structure";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_input);
    EXPECT_NE(std::string(error.what()).find("as femur-1; got femur"), std::string::npos);
  }
}

}  // namespace coxa::pipeline
