#include <coxa/pipeline/subject.h>
#include <coxa/pipeline/virtual_patient.h>

#include "commands.h"

namespace coxa::app {

void add_phantom(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand(
      "phantom", "a virtual patient drawn from the atlas, with its simulated MRI and its truth");
  struct Arguments {
    pipeline::VirtualPatientRequest request;
    std::string side = "right", atlas, out;
    double voxel = 0.0;
  };
  auto arguments = std::make_shared<Arguments>();
  pipeline::VirtualPatientRequest& request = arguments->request;
  verb->add_option("--side", arguments->side, "side of the hip")
      ->check(CLI::IsMember({"left", "right"}));
  verb->add_option("--atlas", arguments->atlas, "atlas file; the shipped one where not given")
      ->check(CLI::ExistingFile);
  verb->add_option("--spread", request.shape.spread, "of the shape, in standard deviations")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--off-model", request.shape.off_model_rms,
                   "mm RMS of a smooth deformation that no shape mode knows")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--voxel", arguments->voxel, "mm, isotropic")->check(CLI::PositiveNumber);
  verb->add_option("--snr", request.image.snr, "signal-to-noise ratio of muscle")
      ->check(CLI::PositiveNumber);
  verb->add_option("--landmark-error", request.landmark_error, "mm, standard deviation")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--out", arguments->out, "folder of the patient")->required();
  verb->callback([arguments, &context] {
    auto& wanted = arguments->request;
    wanted.side = arguments->side == "left" ? Side::left : Side::right;
    wanted.atlas = arguments->atlas.empty() ? pipeline::shipped_data("atlas/hip.coxa-atlas")
                                            : std::filesystem::path(arguments->atlas);
    wanted.seed = context.common.seed;
    if (arguments->voxel > 0.0) wanted.image.voxel = Vec3::Constant(arguments->voxel);
    context.print_result(arguments->out,
                         pipeline::make_virtual_patient(wanted, arguments->out, context.monitor()));
  });
}

}  // namespace coxa::app
