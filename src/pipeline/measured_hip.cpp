#include "measured_hip.h"

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/pipeline/completed_bones.h>
#include <coxa/pipeline/motion_stage.h>
#include <coxa/pipeline/segment_stage.h>
#include <coxa/pipeline/subject.h>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

Side side_of(const Record& segmentation, const fs::path& folder) {
  const auto side = segmentation.options.find("side");
  const auto* name =
      side == segmentation.options.end() ? nullptr : std::get_if<std::string>(&side->second);
  if (name == nullptr || (*name != "left" && *name != "right"))
    fail(ErrorCode::bad_file, (folder / "segment.json").string(), " does not name the side");
  return *name == "left" ? Side::left : Side::right;
}

bool has_motion(const fs::path& run_folder) {
  return fs::exists(run_folder / "motion" / "frames.json") &&
         fs::exists(run_folder / "motion" / "motion.csv");
}

}  // namespace

fs::path segmentation_in(const fs::path& run_folder) {
  for (const fs::path& folder : {run_folder / "segment", run_folder}) {
    if (fs::exists(folder / "segment.json")) return folder;
  }
  fail(ErrorCode::bad_file, run_folder.string(),
       " holds no segmentation (segment/segment.json); run coxa segment or coxa run first");
}

MeasuredHip read_measured_hip(const fs::path& run_folder, const Monitor& monitor) {
  const fs::path segmentation = segmentation_in(run_folder);
  MeasuredHip hip;
  hip.side = side_of(read_record(segmentation / "segment.json"), segmentation);
  hip.surfaces = read_surfaces(segmentation);
  hip.head =
      motion::find_joint_centre(hip.surfaces, joint_centre_options(hip.side), monitor).chosen;
  if (has_motion(run_folder)) {
    hip.frames = read_motion_artefacts(run_folder / "motion", hip.side).frames;
  } else {
    hip.frames = motion::make_bone_frames(hip.surfaces, {}, hip.head.centre, hip.side);
    hip.frames.warnings.push_back("no motion stage: the frames come from the surfaces alone (" +
                                  hip.frames.pelvis.source + "; " + hip.frames.femur.source + ")");
  }
  hip.head.centre = hip.frames.pelvis.X_IB.p;
  return hip;
}

void add_measured_inputs(const fs::path& run_folder, Record& record) {
  const fs::path segmentation = segmentation_in(run_folder);
  for (const auto& [name, surface] : read_surfaces(segmentation))
    record.inputs[name] = io::sha256_of_path(segmentation / (name + ".vtp"));
  record.inputs["segment"] = record_key(read_record(segmentation / "segment.json"));
  if (has_motion(run_folder))
    record.inputs["frames"] = io::sha256_of_path(run_folder / "motion" / "frames.json");
  record.inputs["reference_ranges"] = io::sha256_of_path(shipped_data("reference_ranges.toml"));
}

}  // namespace coxa::pipeline
