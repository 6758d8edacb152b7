#include <coxa/core/error.h>
#include <coxa/pipeline/muscle_names.h>
#include <coxa/pipeline/segment_stage.h>

#include "commands.h"

namespace coxa::app {
namespace {

struct SegmentArguments {
  std::vector<std::string> images;
  std::string series, side, landmarks, structures = "bones,cartilage", atlas, contrast, pins, out;
  double landmark_error = segment::SegmentOptions{}.landmark_error, pin_weight = 1.0;
  bool resume = false;
};

std::vector<std::string> structures_from(const std::string& list) {
  std::map<std::string, std::vector<std::string>> groups{
      {"bones", {"femur", "hip_bone"}},
      {"cartilage", {"femoral_cartilage", "acetabular_cartilage"}},
      {"muscles", pipeline::muscle_names()}};
  for (const char* group : {"bones", "cartilage", "muscles"})
    groups["all"].insert(groups["all"].end(), groups[group].begin(), groups[group].end());
  std::vector<std::string> names;
  for (const std::string& word : CLI::detail::split(list, ',')) {
    const auto group = groups.find(word);
    if (group == groups.end()) {
      names.push_back(word);
    } else {
      names.insert(names.end(), group->second.begin(), group->second.end());
    }
  }
  return names;
}

void run_segment(const SegmentArguments& arguments, Context& context) {
  pipeline::SegmentRequest request;
  for (const std::string& image : arguments.images) {
    request.images.push_back(
        {image, arguments.series.empty() ? std::nullopt : std::optional(arguments.series)});
  }
  request.side = arguments.side == "left" ? Side::left : Side::right;
  request.landmarks = arguments.landmarks;
  request.atlas = arguments.atlas.empty() ? pipeline::shipped_data("atlas/hip.coxa-atlas")
                                          : std::filesystem::path(arguments.atlas);
  request.options.structures = structures_from(arguments.structures);
  request.pins = arguments.pins;
  request.pin_weight = arguments.pin_weight;
  request.options.landmark_error = arguments.landmark_error;
  if (!arguments.contrast.empty()) request.options.contrast = arguments.contrast;
  const auto reuse = arguments.resume ? pipeline::Reuse::if_unchanged : pipeline::Reuse::never;
  const auto record = pipeline::run_segment_stage(request, arguments.out, reuse, context.monitor());
  context.print_result(arguments.out, record);
}

}  // namespace

void add_segment(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand("segment", "surfaces of one hip from its MRI");
  auto arguments = std::make_shared<SegmentArguments>();
  verb->add_option("--image", arguments->images,
                   "NIfTI, NRRD, MetaImage or DICOM folder; several of one patient allowed")
      ->required()
      ->check(CLI::ExistingPath);
  verb->add_option("--series", arguments->series, "which series of a DICOM folder");
  verb->add_option("--side", arguments->side, "side of the hip")
      ->required()
      ->check(CLI::IsMember({"left", "right"}));
  verb->add_option("--landmarks", arguments->landmarks, "landmarks, .mrk.json or CSV")
      ->check(CLI::ExistingFile);
  verb->add_option("--landmark-error", arguments->landmark_error,
                   "expected error of a landmark, mm")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--pins", arguments->pins,
                   "points that a structure's surface passes through, named femur-1, …; "
                   ".mrk.json or CSV")
      ->check(CLI::ExistingFile);
  verb->add_option("--pin-weight", arguments->pin_weight,
                   "how far of the way to its pins a surface goes")
      ->check(CLI::Range(0.0, 1.0));
  verb->add_option("--structures", arguments->structures,
                   "bones, cartilage, muscles, all, or names, separated by commas");
  verb->add_option("--contrast", arguments->contrast,
                   "profiles of the atlas to use; the best fitting where not given");
  verb->add_option("--atlas", arguments->atlas, "atlas file; the shipped one where not given")
      ->check(CLI::ExistingFile);
  verb->add_option("--out", arguments->out, "folder of the result")->required();
  verb->add_flag("--resume", arguments->resume,
                 "keep what an earlier call found there in the same images; pins are set on it");
  verb->callback([arguments, &context] { run_segment(*arguments, context); });
}

}  // namespace coxa::app
