#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/motion_files.h>
#include <coxa/io/track_model.h>
#include <coxa/pipeline/frame_picture.h>
#include <coxa/pipeline/motion_stage.h>
#include <coxa/pipeline/stage.h>

#include <cmath>

#include "commands.h"

namespace coxa::app {
namespace {
namespace fs = std::filesystem;

struct TrackArguments {
  std::string markers, model, config, out;
};

/// The hip model of `--model`: a file as it is; of a folder its hip_model.json, else the only JSON
/// file there.
fs::path model_file(const std::string& argument) {
  const fs::path path = argument;
  if (argument.empty() || !fs::is_directory(path)) return path;
  if (fs::exists(path / "hip_model.json")) return path / "hip_model.json";
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(path)) {
    if (io::extension_of(entry.path()) == ".json") found.push_back(entry.path());
  }
  require(found.size() == 1, argument, " holds no hip_model.json, and ", found.size(),
          " other JSON files; name the file of the hip model");
  return found.front();
}

void add_figures(const motion::TrackedRecording& tracked, pipeline::Record& record) {
  const motion::HipMotion& motion = tracked.result.motion;
  record.figures["frames"] = std::int64_t{motion.n_frames()};
  record.figures["thigh_markers"] = static_cast<std::int64_t>(tracked.result.thigh_labels.size());
  record.figures["side"] = std::string(tracked.model.side == Side::left ? "left" : "right");
  record.figures["method"] = motion.method;
  record.figures["model"] = tracked.model.source;
  record.figures["converged"] = tracked.result.report.converged;
  double sum = 0.0, count = 0.0;
  for (const double r : tracked.result.residuals.reshaped()) {
    if (r == r) sum += r * r, count += 1.0;
  }
  if (count > 0.0) record.figures["residual_rms_mm"] = std::sqrt(sum / count);
  record.warnings = motion.warnings;
}

void run_track(const TrackArguments& arguments, Context& context) {
  const Monitor monitor = context.monitor();
  pipeline::Record wanted;
  wanted.verb = "track";
  wanted.inputs["markers"] = io::sha256_of_path(arguments.markers);
  const fs::path model = model_file(arguments.model), out = arguments.out;
  if (!arguments.config.empty()) wanted.inputs["config"] = io::sha256_of_path(arguments.config);
  if (!model.empty()) wanted.inputs["model"] = io::sha256_of_path(model);
  const auto body = [&](const fs::path& partial, pipeline::Record& record) {
    const auto tracked = pipeline::track_markers(
        {.markers = arguments.markers, .config = arguments.config, .model = model}, monitor);
    if (io::extension_of(out) == ".mot") {
      io::write_opensim_motion(partial / out.filename(), tracked.result.motion, tracked.model.side);
    } else {
      io::write_motion(partial / out.filename(), tracked.result.motion);
    }
    io::write_residuals(partial / (io::stem_of(out) + "_residuals.csv"), tracked.result);
    io::write_bytes(partial / (io::stem_of(out) + "_angles.svg"),
                    view::line_plot_svg(pipeline::angle_plot(tracked.result.motion)));
    if (!tracked.centres.empty())
      io::write_joint_centres(partial / (io::stem_of(out) + "_centres.csv"), tracked.centres);
    if (!tracked.events.empty())
      io::write_events(partial / (io::stem_of(out) + "_events.csv"), tracked.events);
    add_figures(tracked, record);
    for (const std::string& text : record.warnings) monitor.warn(text);
  };
  context.print_result(out.string(), pipeline::run_file(out, wanted, monitor, body));
}

}  // namespace

void add_track(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand("track", "the femur's movement from skin markers");
  auto arguments = std::make_shared<TrackArguments>();
  verb->add_option("--markers", arguments->markers, "C3D, TRC or CSV")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("--model", arguments->model,
                   "hip model: joint centre and markers on the bones (JSON, or a "
                   "folder with hip_model.json); wins over the configuration's")
      ->check(CLI::ExistingPath);
  verb->add_option("--config", arguments->config,
                   "how the recording is to be read and tracked (TOML, docs/motion.md)")
      ->check(CLI::ExistingFile);
  verb->add_option("--out", arguments->out, "CSV, or OpenSim .mot")->required();
  verb->callback([arguments, &context] { run_track(*arguments, context); });
}

}  // namespace coxa::app
