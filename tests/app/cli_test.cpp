// The command line as a user meets it: exit codes, error texts, nothing half-written.
#include <coxa/io/files.h>
#include <coxa/io/surfaces.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

#include "support/shapes.h"

namespace coxa {
namespace fs = std::filesystem;

struct Outcome {
  int exit_code = -1;
  std::string output;  ///< standard output and error together
};

Outcome run_shell(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.output.append(buffer.data(), n);
  outcome.exit_code = WEXITSTATUS(pclose(pipe));
  return outcome;
}

Outcome coxa_run(const std::string& arguments) {
  return run_shell(std::string(COXA_BINARY) + " " + arguments);
}

class CommandLine : public ::testing::Test {
 protected:
  CommandLine() : folder_(fs::temp_directory_path() / ("coxa_cli_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~CommandLine() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static bool has(const Outcome& outcome, const std::string& text) {
    return outcome.output.find(text) != std::string::npos;
  }
  fs::path folder_;
};

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
TEST_F(CommandLine, NamesTheMisspeltKeyOfASubjectFile) {
  io::write_bytes(folder_ / "image.nii.gz", "x");
  io::write_bytes(
      folder_ / "s.toml",
      "sid = \"left\"\n[image]\npath = \"image.nii.gz\"\n[motion]\npattern = \"flexion\"\n");
  const Outcome outcome = coxa_run("run " + path("s.toml"));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_TRUE(has(outcome, "side")) << outcome.output;
}
TEST_F(CommandLine, GivesErrorsAsJsonOnRequest) {
  io::write_bytes(folder_ / "broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
  const Outcome outcome =
      coxa_run("mesh --json --surface " + path("broken.ply") + " --out " + path("m.vtu"));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_TRUE(has(outcome, "{\"error\":{\"code\":\"bad_")) << outcome.output;
}
TEST_F(CommandLine, MeshesAClosedSurfaceAndWritesItsRecord) {
  io::write_surface(folder_ / "shell.ply", test::lunate_shell());
  const Outcome outcome =
      coxa_run("mesh --quiet --surface " + path("shell.ply") + " --out " + path("shell.vtu"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_TRUE(fs::exists(folder_ / "shell.vtu"));
  EXPECT_NE(io::read_bytes(folder_ / "shell.json").find("\"verb\": \"mesh\""), std::string::npos);
}
TEST_F(CommandLine, RefusesAnOpenSurfaceWithThePlaceAndLeavesNothing) {
  io::write_surface(folder_ / "sheet.ply", test::plate(0.0));
  const Outcome outcome =
      coxa_run("mesh --quiet --surface " + path("sheet.ply") + " --out " + path("sheet.vtu"));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_TRUE(has(outcome, "mm")) << outcome.output;
  EXPECT_FALSE(fs::exists(folder_ / "sheet.vtu"));
  EXPECT_FALSE(fs::exists(folder_ / "sheet.json"));
}
TEST_F(CommandLine, SaysWhenTheDiskIsFull) {
  io::write_surface(folder_ / "shell.ply", test::lunate_shell());
  const Outcome outcome =
      coxa_run("mesh --quiet --surface " + path("shell.ply") + " --out /dev/full/shell.vtu");
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
}
TEST_F(CommandLine, EndsWithOneHundredAndThirtyOnCtrlCAndLeavesNothingHalfWritten) {
  if (!fs::exists(fs::path(COXA_SOURCE_DIR) / "data/atlas/hip.coxa-atlas"))
    GTEST_SKIP() << "no shipped atlas";
  const Outcome outcome = run_shell(
      "timeout --preserve-status -s INT 1 " COXA_BINARY " phantom --quiet --out " + path("p"));
  EXPECT_EQ(outcome.exit_code, 130) << outcome.output;
  EXPECT_FALSE(fs::exists(folder_ / "p"));
  EXPECT_FALSE(fs::exists(folder_ / "p.partial"));
}
TEST_F(CommandLine, RefusesASolidBodyAndSaysWhy) {
  io::write_surface(folder_ / "ball.ply", test::icosphere(3, 8.0));
  const Outcome outcome =
      coxa_run("mesh --quiet --surface " + path("ball.ply") + " --out " + path("ball.vtu"));
  EXPECT_EQ(outcome.exit_code, 5);
  EXPECT_TRUE(has(outcome, "no sheet")) << outcome.output;
  EXPECT_FALSE(fs::exists(folder_ / "ball.vtu"));
}
TEST_F(CommandLine, SaysWhatAFileIs) {
  io::write_surface(folder_ / "shell.ply", test::lunate_shell());
  const Outcome outcome = coxa_run("check " + path("shell.ply"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_TRUE(has(outcome, "surface"));
}
TEST_F(CommandLine, RefusesABrokenC3d) {
  const fs::path file = fs::path(COXA_SHARED_DIR) / "data/motion/c3d/bad_parameter_section.c3d";
  if (!fs::exists(file)) GTEST_SKIP() << "needs ../shared/data/motion";
  EXPECT_EQ(
      coxa_run("track --quiet --markers " + file.string() + " --out " + path("m.csv")).exit_code,
      3);
  EXPECT_FALSE(fs::exists(folder_ / "m.csv"));
}

}  // namespace coxa
