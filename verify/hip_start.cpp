// Where a hip is found without landmarks, against where it is: docs/segment.md.
#include <coxa/core/error.h>
#include <coxa/io/atlas_file.h>
#include <coxa/io/volumes.h>
#include <coxa/pipeline/segment_stage.h>
#include <coxa/segment/placement.h>
#include <coxa/segment/pose_search.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>

namespace coxa {
namespace {

struct Arguments {
  std::string image, atlas, side = "right", series;
  std::vector<double> head;
};

void print_start(const Arguments& arguments) {
  const bool left = arguments.side == "left";
  const shape::Atlas atlas = io::read_atlas(arguments.atlas);
  const std::optional<std::string> series =
      arguments.series.empty() ? std::nullopt : std::optional(arguments.series);
  const Volume volume = pipeline::read_image({arguments.image, series}, {}, {});
  const segment::PreparedImage image =
      segment::prepare_image(left ? segment::mirrored(volume) : volume, true);
  const auto begin = std::chrono::steady_clock::now();
  const segment::FoundPose found = segment::find_pose(
      {&shape::structure(atlas, "femur"), &shape::structure(atlas, "hip_bone")}, {image}, {});
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  Vec3 centre = found.centre;
  if (left) centre.x() = -centre.x();
  std::printf("| %s | %s | %.1f %.1f %.1f |", arguments.image.c_str(), arguments.side.c_str(),
              centre.x(), centre.y(), centre.z());
  if (arguments.head.size() == 3)
    std::printf(" %.1f |",
                (centre - Vec3(arguments.head[0], arguments.head[1], arguments.head[2])).norm());
  else
    std::printf(" |");
  std::printf(" %s | %.3f | %.3f | %.1f s |\n", found.contrast.c_str(), found.score, found.margin,
              seconds);
}

}  // namespace
}  // namespace coxa

int main(int argc, char** argv) {
  CLI::App app{"Where a hip is found without landmarks"};
  coxa::Arguments arguments;
  app.add_option("image", arguments.image, "file, or folder of DICOM")->required();
  app.add_option("--atlas", arguments.atlas, "free of the subject")->required();
  app.add_option("--side", arguments.side, "left or right")->required();
  app.add_option("--series", arguments.series, "of a DICOM folder");
  app.add_option("--head", arguments.head, "true centre of the head, LPS mm")->expected(3);
  CLI11_PARSE(app, argc, argv);
  try {
    coxa::print_start(arguments);
  } catch (const coxa::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
