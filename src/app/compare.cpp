#include <coxa/pipeline/compare.h>

#include "commands.h"

namespace coxa::app {

void add_compare(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand("compare",
                                  "distances between the surfaces of two folders, or of two files");
  struct Arguments {
    std::string a, b, image;
  };
  auto arguments = std::make_shared<Arguments>();
  verb->add_option("a", arguments->a, "folder of surfaces, or a surface")
      ->required()
      ->check(CLI::ExistingPath);
  verb->add_option("b", arguments->b, "what it is compared with, taken as the truth")
      ->required()
      ->check(CLI::ExistingPath);
  verb->add_option("--image", arguments->image,
                   "judge only what lies in this image's field of view")
      ->check(CLI::ExistingPath);
  verb->callback([arguments, &context] {
    pipeline::Record record;
    for (const auto& [name, d] :
         pipeline::compare(arguments->a, arguments->b, arguments->image, context.monitor())) {
      record.figures[name + "_average_distance_mm"] = d.assd;
      record.figures[name + "_95th_percentile_mm"] = d.hd95;
      record.figures[name + "_bias_mm"] = d.bias;
    }
    context.print_result(arguments->a, record);
  });
}

}  // namespace coxa::app
