#include <coxa/pipeline/defaults.h>

#include <coxa/pipeline/subject.h>
#include <gtest/gtest.h>

#include "pipeline/small_run.h"

namespace coxa::pipeline {

TEST(Defaults, WrittenIntoASubjectFileChangeNothing) {
  const test::SmallRun run("defaults");
  const std::string head =
      "side = \"left\"\n[image]\npath = \"image.nii.gz\"\n[motion]\npattern = \"flexion\"\n";
  io::write_bytes(run / "plain.toml", head);
  auto sections = default_options();
  std::map<std::string, Fields> tables = {{"mesh", sections.at("mesh")},
                                          {"joint", sections.at("joint")}};
  // the motion table is open at the end of `head`
  std::string motion = to_toml({{"motion", sections.at("motion")}});
  motion.erase(0, motion.find('\n') + 1);
  io::write_bytes(run / "full.toml", head + motion + to_toml(tables));
  const Subject plain = read_subject(run / "plain.toml"), full = read_subject(run / "full.toml");
  EXPECT_EQ(full.motion.frames, plain.motion.frames);
  EXPECT_EQ(full.mesh.layers, plain.mesh.layers);
  EXPECT_EQ(full.mesh.max_tets, plain.mesh.max_tets);
  EXPECT_EQ(full.joint.force, plain.joint.force);
  EXPECT_EQ(full.joint.loading, plain.joint.loading);
  EXPECT_EQ(full.joint.youngs_modulus, plain.joint.youngs_modulus);
  EXPECT_EQ(full.joint.poisson_ratio, plain.joint.poisson_ratio);
  EXPECT_EQ(full.joint.law, plain.joint.law);
}
TEST(Defaults, AreTomlWithATableForEverySection) {
  const test::SmallRun run("defaults_toml");
  const auto sections = default_options();
  io::write_bytes(run / "all.toml", to_toml(sections));
  const io::Table root = io::Table::read(run / "all.toml");
  EXPECT_EQ(root.keys().size(), sections.size());
  EXPECT_DOUBLE_EQ(root.find_table("rom")->get<double>("step_deg"), 1.0);
  EXPECT_EQ(root.find_table("track")->get<std::string>("method"), "coxa");
}

}  // namespace coxa::pipeline
