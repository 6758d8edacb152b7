#pragma once

#include <CLI/CLI.hpp>

#include "context.h"

namespace coxa::app {

// Each adds one verb to the command line; the verb runs while CLI11 parses, and throws on failure.
void add_run(CLI::App& app, Context& context);
void add_segment(CLI::App& app, Context& context);
void add_mesh(CLI::App& app, Context& context);
void add_track(CLI::App& app, Context& context);
void add_simulate(CLI::App& app, Context& context);
void add_report(CLI::App& app, Context& context);
void add_compare(CLI::App& app, Context& context);
void add_phantom(CLI::App& app, Context& context);
void add_atlas(CLI::App& app, Context& context);
void add_check(CLI::App& app, Context& context);
void add_measure(CLI::App& app, Context& context);
void add_rom(CLI::App& app, Context& context);
void add_config(CLI::App& app, Context& context);
void add_view(CLI::App& app, Context& context);

}  // namespace coxa::app
