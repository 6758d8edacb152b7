#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <exception>

#include "commands.h"

namespace coxa::app {
namespace {

void add_common_flags(CLI::App& verb, CommonOptions& common) {
  verb.add_option("--threads", common.threads,
                  "threads to use; all of the machine's where not given")
      ->check(CLI::PositiveNumber);
  verb.add_option("--seed", common.seed, "seed of everything random");
  verb.add_flag("--json", common.json, "progress, result and errors as JSON lines");
  verb.add_flag("--quiet", common.quiet, "no progress");
  verb.add_flag(
      "-v", common.verbose,
      "a log on standard error: steps with their times; options, inputs and figures in full");
}

void add_verbs(CLI::App& app, Context& context) {
  add_run(app, context);
  add_segment(app, context);
  add_mesh(app, context);
  add_track(app, context);
  add_simulate(app, context);
  add_measure(app, context);
  add_rom(app, context);
  add_report(app, context);
  add_compare(app, context);
  add_phantom(app, context);
  add_atlas(app, context);
  add_check(app, context);
  add_config(app, context);
  add_view(app, context);
}

int usage_error(const CLI::App& app, const CLI::ParseError& error, Context& context) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
  return context.print_error("usage", std::string(error.what()) + "; see coxa --help", 2);
}

int run(int argc, char** argv) {
  Context context;
  CLI::App app{"coxa: from hip MRI and movement to the stress in the hip's cartilage", "coxa"};
  app.set_version_flag("--version", pipeline::version());
  app.require_subcommand(1);
  add_verbs(app, context);
  // groups of options are listed among the subcommands, without a name
  const auto is_verb = [](CLI::App* entry) { return !entry->get_name().empty(); };
  for (CLI::App* verb : app.get_subcommands({})) {
    const auto nested = verb->get_subcommands(is_verb);
    for (CLI::App* target : nested) add_common_flags(*target, context.common);
    if (nested.empty()) add_common_flags(*verb, context.common);
  }
  app.parse_complete_callback([&] {
    if (context.common.threads > 0) set_thread_count(context.common.threads);
  });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return usage_error(app, error, context);
  } catch (const Error& error) {
    return context.print_error(name(error.code()), error.what(), exit_code(error.code()));
  } catch (const std::bad_alloc&) {
    return context.print_error("bad_input", "not enough memory for this input", 3);
  } catch (const std::exception& error) {
    return context.print_error("internal", std::string("internal error: ") + error.what(), 1);
  }
  return 0;
}

}  // namespace
}  // namespace coxa::app

int main(int argc, char** argv) { return coxa::app::run(argc, argv); }
