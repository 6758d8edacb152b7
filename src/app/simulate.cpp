#include <coxa/pipeline/joint_stage.h>

#include "commands.h"

namespace coxa::app {

void add_simulate(CLI::App& app, Context& context) {
  auto* verb =
      app.add_subcommand("simulate", "stress in the cartilage over a movement, from meshes");
  auto joint = std::make_shared<std::string>(), out = std::make_shared<std::string>();
  verb->add_option("joint", *joint, "joint file (JOINT.toml)")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("--out", *out, "folder of the result")->required();
  verb->callback([joint, out, &context] {
    const auto request = pipeline::read_joint_request(*joint);
    context.print_result(
        *out, pipeline::run_joint_stage(request, *out, pipeline::Reuse::never, context.monitor()));
  });
}

}  // namespace coxa::app
