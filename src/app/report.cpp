#include <coxa/pipeline/report_stage.h>

#include "commands.h"

namespace coxa::app {

void add_report(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand("report", "report.html of a finished run, drawn again");
  auto folder = std::make_shared<std::string>(), file = std::make_shared<std::string>();
  verb->add_option("folder", *folder, "folder of a run")->required()->check(CLI::ExistingDirectory);
  verb->add_option("--subject", *file, "subject file of that run")
      ->required()
      ->check(CLI::ExistingFile);
  verb->callback([folder, file, &context] {
    const std::filesystem::path run = *folder;
    const auto record =
        pipeline::run_report_stage(pipeline::read_subject(*file), run, run / "report",
                                   pipeline::Reuse::never, context.monitor());
    context.print_result((run / "report" / "report.html").string(), record);
  });
}

}  // namespace coxa::app
