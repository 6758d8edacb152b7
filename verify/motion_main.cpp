// Joint centres, bone frames and clearances on real bones: docs/motion.md section 8.
#include <coxa/core/error.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "motion_cases.h"

int main(int argc, char** argv) {
  CLI::App app{"Joint centres, bone frames and clearances on real bones"};
  app.require_subcommand(1);
  std::string shared = "../shared", atlas, out = "data/femoral_head.toml";
  app.add_option("--shared", shared, "folder with data/libhip, data/visible_human");
  auto* centres = app.add_subcommand("centres", "spread of the definitions, noise, half a head");
  auto* heads = app.add_subcommand("learn-heads", "mean shape of the heads of libhip");
  heads->add_option("--out", out, "file to write");
  auto* frames = app.add_subcommand("frames", "frames of cropped bones against whole ones");
  frames->add_option("--atlas", atlas, "made without vhf and vhm")->required();
  std::vector<std::string> trials;
  auto* collisions = app.add_subcommand("collisions", "bones of a real hip in tracked poses");
  collisions->add_option("trials", trials, "prefixes of sta_simulate.py's files")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    if (centres->parsed()) coxa::verify::print_centres(shared);
    if (heads->parsed()) coxa::verify::learn_heads(shared, out);
    if (collisions->parsed()) coxa::verify::print_collisions(shared, trials);
    if (frames->parsed()) coxa::verify::print_frames(shared, atlas);
  } catch (const coxa::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
