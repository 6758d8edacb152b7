#include <coxa/pipeline/run.h>

#include "commands.h"

namespace coxa::app {
namespace {

struct RunArguments {
  std::string subject, out, from;
  bool resume = false;
};

void run_chain(const RunArguments& arguments, Context& context) {
  const pipeline::Subject subject = pipeline::read_subject(arguments.subject);
  const std::filesystem::path out =
      arguments.out.empty()
          ? std::filesystem::path(arguments.subject).parent_path() / (subject.name + "_result")
          : std::filesystem::path(arguments.out);
  pipeline::RunOptions options;
  if (!arguments.from.empty()) options.from = arguments.from;
  // without --resume a run of its own starts from nothing, so that no stage of an older run is
  // mistaken for its own
  if (!arguments.resume && arguments.from.empty()) options.from = pipeline::kStages[0];
  options.on_stage = [&](const pipeline::Record& record) { context.log_record(record); };
  const auto records = pipeline::run_subject(subject, out, options, context.monitor());
  pipeline::Record summary;
  for (const pipeline::Record& record : records) {
    summary.figures[record.verb + "_seconds"] = record.seconds;
    summary.figures["peak_memory_mb"] = record.peak_memory_mb;
    if (record.verb == "joint")
      summary.figures.insert(record.figures.begin(), record.figures.end());
  }
  context.print_result((out / "report" / "report.html").string(), summary);
}

}  // namespace

void add_run(CLI::App& app, Context& context) {
  auto* verb =
      app.add_subcommand("run", "the whole chain: MRI and movement in, cartilage stress out");
  auto arguments = std::make_shared<RunArguments>();
  verb->add_option("subject", arguments->subject, "subject file (SUBJECT.toml)")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("--out", arguments->out,
                   "folder of the result; <name>_result beside the file where not given");
  verb->add_option("--from", arguments->from,
                   "run this stage and those after it again, keep the ones before");
  verb->add_flag("--resume", arguments->resume,
                 "keep every stage whose inputs and options have not changed");
  verb->callback([arguments, &context] { run_chain(*arguments, context); });
}

}  // namespace coxa::app
