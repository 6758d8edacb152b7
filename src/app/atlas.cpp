#include <coxa/io/atlas_file.h>
#include <coxa/io/files.h>
#include <coxa/pipeline/atlas_stage.h>
#include <coxa/pipeline/subject.h>

#include "commands.h"

namespace coxa::app {
namespace {

void add_build(CLI::App& verb, Context& context) {
  auto* build =
      verb.add_subcommand("build", "generic models, shape modes and profiles from example hips");
  auto request = std::make_shared<pipeline::AtlasRequest>();
  auto out = std::make_shared<std::string>();
  build->add_option("--data", request->data, "folder with libhip, visible_human, labels/pelvic_ref")
      ->check(CLI::ExistingDirectory);
  build
      ->add_option("--add", request->examples.own,
                   "a hip you segmented, left or right in its name: folder of femur.ply, "
                   "hip_bone.ply, …, or label map with names")
      ->check(CLI::ExistingPath);
  build->add_option("--exclude", request->examples.exclude,
                    "subject to leave out, both sides, for example m2");
  build->add_option("--exclude-structure", request->examples.exclude_structures,
                    "structure of a set to leave out, for example libhip:hip_bone");
  build->add_option("--contrasts", request->profiles.contrasts,
                    "contrasts to learn profiles for: t1 t2 pd dess");
  build
      ->add_option("--profile-hips", request->profiles.n_hips, "virtual hips per class of profiles")
      ->check(CLI::PositiveNumber);
  build->add_flag("!--no-muscles", request->muscles, "bones and cartilages only");
  build
      ->add_option("--base", request->base,
                   "atlas whose bones and cartilages are taken; only muscles are built")
      ->check(CLI::ExistingFile);
  build->add_option("--out", *out, "atlas file to write")->required();
  build->callback([request, out, &context] {
    request->profiles.seed = context.common.seed;
    context.print_result(*out, pipeline::build_atlas_file(*request, *out, context.monitor()));
  });
}

void print_info(const std::string& path, Context& context) {
  const shape::Atlas atlas = io::read_atlas(path);
  pipeline::Record record;
  record.figures["subjects"] = static_cast<std::int64_t>(atlas.subjects.size());
  for (const shape::StructureModel& model : atlas.structures) {
    const SimplexMesh& finest = model.hierarchy.levels.back();
    record.figures[model.name + "_resolutions"] =
        static_cast<std::int64_t>(model.hierarchy.levels.size());
    record.figures[model.name + "_vertices"] = std::int64_t{finest.n_vertices()};
    record.figures[model.name + "_modes"] =
        static_cast<std::int64_t>(model.shape.deviations.size());
    record.figures[model.name + "_leave_one_out_mm"] = model.leave_one_out_error;
    for (const shape::ProfileSet& set : model.profiles) {
      record.figures[model.name + "_profiles_" + set.contrast + "_reliability"] =
          set.reliability.mean();
    }
  }
  context.print_result(path, record);
  for (const std::string& subject : atlas.subjects) context.say("  from " + subject);
  context.say(atlas.attribution);
}

}  // namespace

void add_atlas(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand("atlas", "the generic models that segmentation starts from");
  verb->require_subcommand(1);
  add_build(*verb, context);
  auto* info = verb->add_subcommand("info", "what an atlas holds");
  auto path =
      std::make_shared<std::string>(pipeline::shipped_data("atlas/hip.coxa-atlas").string());
  info->add_option("atlas", *path, "atlas file; the shipped one where not given")
      ->check(CLI::ExistingFile);
  info->callback([path, &context] { print_info(*path, context); });
}

}  // namespace coxa::app
