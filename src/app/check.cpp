#include <coxa/core/error.h>
#include <coxa/io/inspect.h>

#include "commands.h"

namespace coxa::app {
namespace {

void run_check(const std::string& path, Context& context) {
  const io::Inspection inspection = io::inspect(path);
  pipeline::Record record;
  record.figures["kind"] = inspection.kind;
  record.figures["usable"] = inspection.usable();
  context.print_result(path, record);
  for (const std::string& fact : inspection.facts) context.say("  " + fact);
  const Monitor monitor = context.monitor();
  for (const std::string& warning : inspection.warnings) monitor.warn(warning);
  if (inspection.usable()) return;
  std::string text = path + " is not usable:";
  for (const std::string& problem : inspection.problems) text += "\n  " + problem;
  fail(ErrorCode::bad_input, text);
}

}  // namespace

void add_check(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand("check", "what is this file or folder, and can coxa use it?");
  auto path = std::make_shared<std::string>();
  verb->add_option("path", *path, "image, surface, mesh, motion, landmarks or subject")->required();
  verb->callback([path, &context] { run_check(*path, context); });
}

}  // namespace coxa::app
