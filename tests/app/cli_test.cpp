// The command line as a user meets it: exit codes, error texts, nothing half-written.
#include <coxa/io/files.h>
#include <coxa/io/surfaces.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "app/command.h"
#include "pipeline/small_run.h"
#include "support/shapes.h"

namespace coxa {
namespace fs = std::filesystem;

using test::coxa_run, test::Outcome, test::run_shell;

class CommandLine : public test::CommandTest {};

TEST_F(CommandLine, PrintsItsVersion) {
  const Outcome outcome = coxa_run("--version");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_FALSE(outcome.output.empty());
}
TEST_F(CommandLine, EndsWithTwoForAVerbOrOptionItDoesNotKnow) {
  EXPECT_EQ(coxa_run("segmnt").exit_code, 2);
  EXPECT_EQ(coxa_run("mesh --surfce x").exit_code, 2);
  EXPECT_EQ(coxa_run("").exit_code, 2);
}
TEST_F(CommandLine, GivesErrorsAsJsonOnRequest) {
  io::write_bytes(folder_ / "broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
  const Outcome outcome =
      coxa_run("mesh --json --surface " + path("broken.ply") + " --out " + path("m.vtu"));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_TRUE(outcome.says("{\"error\":{\"code\":\"bad_")) << outcome.output;
}
TEST_F(CommandLine, MeshesAClosedSurfaceAndWritesItsRecord) {
  io::write_surface(folder_ / "shell.ply", test::lunate_shell());
  const Outcome outcome =
      coxa_run("mesh --quiet --surface " + path("shell.ply") + " --out " + path("shell.vtu"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_TRUE(fs::exists(folder_ / "shell.vtu"));
  EXPECT_NE(io::read_bytes(folder_ / "shell.json").find("\"verb\": \"mesh\""), std::string::npos);
}
TEST_F(CommandLine, LogsStepsAndTheWholeRecordOnlyWhenAskedTo) {
  io::write_surface(folder_ / "shell.ply", test::lunate_shell());
  const std::string mesh = "mesh --surface " + path("shell.ply") + " --out " + path("shell.vtu");
  const Outcome plain = coxa_run(mesh), verbose = coxa_run(mesh + " -v");
  EXPECT_EQ(verbose.exit_code, 0) << verbose.output;
  for (const char* part :
       {" s  mesh:   0 %", "option  max_tets", "input   surface", "figure  tets"}) {
    EXPECT_TRUE(verbose.says(part)) << part << "\n" << verbose.output;
    EXPECT_FALSE(plain.says(part)) << part << "\n" << plain.output;
  }
  EXPECT_TRUE(coxa_run(mesh + " -v --json").says("{\"record\":{\"coxa_version\""));
}
TEST_F(CommandLine, FillsASolidBodyAndSaysHowUnlessASheetIsDemanded) {
  io::write_surface(folder_ / "ball.ply", test::icosphere(3, 8.0));
  const std::string mesh = "mesh --surface " + path("ball.ply") + " --out " + path("ball.vtu");
  const Outcome refused = coxa_run(mesh + " --quiet --method medial");
  EXPECT_EQ(refused.exit_code, 5);
  EXPECT_TRUE(refused.says("no sheet")) << refused.output;
  EXPECT_FALSE(fs::exists(folder_ / "ball.vtu"));
  const Outcome filled = coxa_run(mesh + " --tets 5000");
  EXPECT_EQ(filled.exit_code, 0) << filled.output;
  EXPECT_TRUE(filled.says("lattice")) << filled.output;
  EXPECT_NE(io::read_bytes(folder_ / "ball.json").find("no sheet"), std::string::npos);
}
TEST_F(CommandLine, MeasuresAHipAndItsRangeOfMotion) {
  const test::SmallRun run("cli_measure");
  const std::string folder = (run / "").string();
  const Outcome measured = coxa_run("measure --quiet " + folder);
  EXPECT_EQ(measured.exit_code, 0) << measured.output;
  EXPECT_TRUE(fs::exists(run / "measure" / "measure.json"));
  const Outcome moved = coxa_run("rom --step 4 " + folder);
  EXPECT_EQ(moved.exit_code, 0) << moved.output;
  EXPECT_TRUE(moved.says("flexion_end") && moved.says("bones touch")) << moved.output;
  EXPECT_NE(io::read_bytes(run / "rom" / "rom.json").find("\"step_deg\": 4"), std::string::npos);
  EXPECT_EQ(coxa_run("rom --step 0 " + folder).exit_code, 2);
  EXPECT_EQ(coxa_run("measure " + path("")).exit_code, 3);
}
TEST_F(CommandLine, PrintsItsDefaults) {
  const Outcome toml = coxa_run("config"), json = coxa_run("config --json");
  EXPECT_EQ(toml.exit_code, 0);
  EXPECT_TRUE(toml.says("[joint]\nbare_bone = \"hip_bone\"\nforce_N = 500.0\n")) << toml.output;
  EXPECT_TRUE(json.says("\"joint.force_N\":500.0")) << json.output;
}
TEST_F(CommandLine, SaysWhatAFileIs) {
  io::write_surface(folder_ / "shell.ply", test::lunate_shell());
  const Outcome outcome = coxa_run("check " + path("shell.ply"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_TRUE(outcome.says("surface"));
}

}  // namespace coxa
