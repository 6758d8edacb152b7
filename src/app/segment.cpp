#include <coxa/core/error.h>
#include <coxa/pipeline/segment_stage.h>
#include <coxa/pipeline/structures.h>
#include <coxa/pipeline/surface_stage.h>
#include <coxa/shape/hip_structures.h>

#include "commands.h"

namespace coxa::app {
namespace {

struct SegmentArguments {
  std::vector<std::string> images;
  std::string series, side, landmarks, structures = "bones,cartilage", atlas, contrast, pins,
                                       labels, surfaces, out;
  double landmark_error = segment::SegmentOptions{}.landmark_error, pin_weight = 1.0;
  bool resume = false;
};

/// A hip segmented elsewhere: labrum and ligaments are made on its bones and cartilages.
pipeline::SurfaceRequest surface_request(const SegmentArguments& arguments) {
  pipeline::SurfaceRequest request;
  request.side = arguments.side == "left" ? Side::left : Side::right;
  request.structures = pipeline::structures_from(arguments.structures);
  for (const char* name : shape::kHipStructures) {
    const std::filesystem::path folder = arguments.surfaces;
    for (const char* extension : {".ply", ".stl", ".vtp", ".obj"}) {
      if (!request.surfaces.contains(name) &&
          std::filesystem::exists(folder / (name + std::string(extension))))
        request.surfaces[name] = folder / (name + std::string(extension));
    }
    require(request.surfaces.contains(name), folder.string(), " holds no surface ", name,
            " (.ply, .stl, .vtp or .obj)");
  }
  return request;
}

void run_segment(const SegmentArguments& arguments, Context& context) {
  const auto reuse = arguments.resume ? pipeline::Reuse::if_unchanged : pipeline::Reuse::never;
  if (!arguments.surfaces.empty()) {
    const auto record = pipeline::run_surface_stage(surface_request(arguments), arguments.out,
                                                    reuse, context.monitor());
    context.print_result(arguments.out, record);
    return;
  }
  pipeline::SegmentRequest request;
  for (const std::string& image : arguments.images) {
    request.images.push_back(
        {image, arguments.series.empty() ? std::nullopt : std::optional(arguments.series)});
  }
  request.side = arguments.side == "left" ? Side::left : Side::right;
  request.landmarks = arguments.landmarks;
  request.atlas = arguments.atlas.empty() ? pipeline::shipped_data("atlas/hip.coxa-atlas")
                                          : std::filesystem::path(arguments.atlas);
  request.options.structures = pipeline::structures_from(arguments.structures);
  request.pins = arguments.pins;
  request.pin_weight = arguments.pin_weight;
  request.labels = arguments.labels;
  request.options.landmark_error = arguments.landmark_error;
  if (!arguments.contrast.empty()) request.options.contrast = arguments.contrast;
  const auto record = pipeline::run_segment_stage(request, arguments.out, reuse, context.monitor());
  context.print_result(arguments.out, record);
}

}  // namespace

void add_segment(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand("segment", "surfaces of one hip from its MRI");
  auto arguments = std::make_shared<SegmentArguments>();
  auto* source = verb->add_option_group("source");
  source
      ->add_option("--image", arguments->images,
                   "NIfTI, NRRD, MetaImage or DICOM folder; several of one patient allowed")
      ->check(CLI::ExistingPath);
  source
      ->add_option("--surfaces", arguments->surfaces,
                   "in place of images: folder of bones and cartilages segmented elsewhere, for "
                   "labrum and ligaments")
      ->check(CLI::ExistingDirectory);
  source->require_option(1);
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
  verb->add_option(
      "--structures", arguments->structures,
      "bones, cartilage, muscles, labrum, ligaments, all, or names, separated by commas");
  verb->add_option("--labels", arguments->labels,
                   "label map of an earlier result, corrected by hand: surfaces follow it")
      ->check(CLI::ExistingFile);
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
