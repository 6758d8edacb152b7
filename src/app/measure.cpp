#include <coxa/pipeline/measure_stage.h>

#include "commands.h"

namespace coxa::app {

void add_measure(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand(
      "measure", "thickness of both cartilages and shape of the hip, into DIR/measure");
  struct Arguments {
    std::string folder;
    measure::ThicknessOptions options;
  };
  auto arguments = std::make_shared<Arguments>();
  verb->add_option("folder", arguments->folder, "folder of a run, or of a segmentation")
      ->required()
      ->check(CLI::ExistingDirectory);
  verb->add_option("--max-thickness", arguments->options.max_thickness,
                   "mm; bone without cartilage this near counts as bare")
      ->check(CLI::PositiveNumber);
  verb->callback([arguments, &context] {
    const std::filesystem::path folder = arguments->folder;
    const auto record = pipeline::run_measure_stage(folder, arguments->options,
                                                    pipeline::Reuse::never, context.monitor());
    context.print_result((folder / "measure").string(), record);
  });
}

void add_rom(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand(
      "rom",
      "range of motion until the bones first touch, into DIR/rom: flexion, internal "
      "rotation at 90 degrees, FADIR, FABER");
  struct Arguments {
    std::string folder;
    measure::RomOptions options;
    double step_deg = degrees(measure::RomOptions{}.step);
  };
  auto arguments = std::make_shared<Arguments>();
  verb->add_option("folder", arguments->folder, "folder of a run, or of a segmentation")
      ->required()
      ->check(CLI::ExistingDirectory);
  verb->add_option("--threshold", arguments->options.threshold,
                   "mm, distance of the bones that counts as contact");
  verb->add_option("--step", arguments->step_deg, "degrees between the poses tried")
      ->check(CLI::PositiveNumber);
  verb->callback([arguments, &context] {
    const std::filesystem::path folder = arguments->folder;
    measure::RomOptions options = arguments->options;
    options.step = radians(arguments->step_deg);
    const auto record =
        pipeline::run_rom_stage(folder, options, pipeline::Reuse::never, context.monitor());
    context.print_result((folder / "rom").string(), record);
  });
}

}  // namespace coxa::app
