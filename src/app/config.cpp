#include <coxa/pipeline/defaults.h>

#include "commands.h"

namespace coxa::app {

void add_config(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand(
      "config", "prints every default as TOML; motion, mesh and joint are a subject file's tables");
  verb->callback([&context] {
    const auto sections = pipeline::default_options();
    if (!context.common.json) return context.print_text(pipeline::to_toml(sections));
    pipeline::Record record;
    for (const auto& [section, fields] : sections)
      for (const auto& [key, value] : fields) record.figures[section + "." + key] = value;
    context.print_result("defaults", record);
  });
}

}  // namespace coxa::app
