#include "../../src/pipeline/joint_files.h"

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/pipeline/joint_stage.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "pipeline/small_run.h"

namespace coxa::pipeline {
namespace {

namespace fs = std::filesystem;

const std::string kTable =
    "[joint]\nbare_bone = \"both\"\nfriction = 0.02\n"
    "[[joint.ligament]]\nname = \"iliofemoral_ligament\"\norigin_lps_mm = [0.0, -20.0, 25.0]\n"
    "insertion_lps_mm = [0.0, -20.0, -25.0]\nstiffness_N_per_mm = 20.0\nwrap_radius_mm = 23.5\n"
    "[[joint.ligament]]\nname = \"loose\"\norigin_lps_mm = [10.0, 0.0, 40.0]\n"
    "insertion_lps_mm = [0.0, 30.0, -30.0]\nstiffness_N_per_mm = 5.0\nslack_length_mm = 300.0\n";

Subject subject_of(const test::SmallRun& small, const std::string& joint) {
  std::string text = "side = \"right\"\n[surfaces]\n";
  for (const std::string name : {"femur", "hip_bone", "femoral_cartilage", "acetabular_cartilage"})
    text += name + " = \"segment/" + name + ".vtp\"\n";
  text += "[motion]\npattern = \"flexion\"\nframes = 2\n" + joint;
  io::write_bytes(small / "given.toml", text);
  return read_subject(small / "given.toml");
}
std::string error_of(const std::string& joint) {
  const test::SmallRun small("ligament_error");
  try {
    subject_of(small, joint);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}
std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> found;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) found.push_back(cell);
  if (!line.empty() && line.back() == ',') found.emplace_back();
  return found;
}

TEST(Ligaments, HaveAColumnEachInTheSummary) {
  motion::HipMotion motion;
  motion.time = {0.0, 1.0};
  joint::JointResult result;
  result.frames.resize(2);
  result.frames[0].status = joint::FrameStatus::converged;
  result.frames[1].reason = "no equilibrium";
  const auto lines_of = [&] {
    std::stringstream stream(summary_csv(motion, result));
    std::vector<std::vector<std::string>> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(cells(line));
    return lines;
  };
  const auto without = lines_of();
  result.has_labrum = true;
  result.frames[0].labrum_clearance = 1.5;
  result.bare_bone = joint::BareBone::both;
  result.has_friction = true;
  result.ligaments = {"iliofemoral_ligament", "loose"};
  result.frames[0].ligament_tension = Vec2(12.5, 0.0);
  result.frames[0].balance.force_of_femur = Vec3(0.0, 0.0, 33.0);
  result.frames[0].balance.friction_moment = Vec3(0.0, 3.0, 4.0);
  const auto lines = lines_of();
  ASSERT_EQ(lines.size(), 3U);
  for (const auto& line : lines) EXPECT_EQ(line.size(), lines[0].size());
  EXPECT_EQ(lines[0].size(), without[0].size() + 6);
  const auto value = [&](std::size_t line, const std::string& name) {
    const auto& names = lines[0];
    const auto place = std::find(names.begin(), names.end(), name) - names.begin();
    return lines.at(line).at(static_cast<std::size_t>(place));
  };
  EXPECT_EQ(value(1, "labrum_clearance_mm"), "1.5");
  EXPECT_EQ(value(1, "force_of_bare_femur_N"), "33");
  EXPECT_EQ(value(1, "friction_moment_Nmm"), "5");
  EXPECT_EQ(value(1, "tension_iliofemoral_ligament_N"), "12.5");
  EXPECT_EQ(value(1, "tension_loose_N"), "0");
  EXPECT_EQ(value(2, "tension_loose_N"), "");
  EXPECT_EQ(value(2, "reason"), "\"no equilibrium\"");
}
TEST(Ligaments, AreWrittenToTheJointFileAsTheyWereRead) {
  const test::SmallRun small("ligament_file");
  const Subject subject = subject_of(small, kTable);
  JointRequest request;
  request.side = Side::right;
  request.acetabular_cartilage = small / "mesh/acetabular_cartilage.vtu";
  request.femoral_cartilage = small / "mesh/femoral_cartilage.vtu";
  request.hip_bone = small / "segment/hip_bone.vtp";
  request.femur = small / "segment/femur.vtp";
  request.motion = small / "mesh";
  request.labrum = small / "segment/acetabular_cartilage.vtp";
  request.joint = subject.joint;
  io::write_bytes(small / "joint.toml", to_toml(request, small / ""));
  const JointRequest again = read_joint_request(small / "joint.toml");
  EXPECT_EQ(again.joint.bare_bone, "both");
  EXPECT_EQ(again.joint.friction, 0.02);
  EXPECT_TRUE(fs::equivalent(again.labrum, request.labrum));
  ASSERT_EQ(again.joint.ligaments.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const LigamentEntry &a = subject.joint.ligaments[k], &b = again.joint.ligaments[k];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.origin, b.origin);
    EXPECT_EQ(a.insertion, b.insertion);
    EXPECT_EQ(a.stiffness, b.stiffness);
    EXPECT_EQ(a.slack_length, b.slack_length);
    EXPECT_EQ(a.wrap_radius, b.wrap_radius);
  }
  motion::BoneFrames frames;
  const joint::JointModel model = read_joint_model(again, frames);
  EXPECT_EQ(model.bare_bone, joint::BareBone::both);
  EXPECT_EQ(model.friction, 0.02);
  EXPECT_FALSE(model.labrum.empty());
  // without a slack length as long as in the image pose: around the head, longer than straight
  EXPECT_EQ(model.ligaments[0].slack_length,
            joint::image_length(model.ligaments[0], frames.femur.X_IB.p));
  EXPECT_GT(model.ligaments[0].slack_length, 50.1);
  EXPECT_EQ(model.ligaments[1].slack_length, 300.0);
}
TEST(Labrum, OfTheJointFileIsTheSoftOneWithItsModulus) {
  const test::SmallRun small("labrum_file");
  JointRequest request;
  request.acetabular_cartilage = request.labrum_mesh = small / "mesh/acetabular_cartilage.vtu";
  request.femoral_cartilage = small / "mesh/femoral_cartilage.vtu";
  request.motion = small / "mesh";
  request.joint.labrum_modulus = 33.0;
  request.joint.labrum_poisson_ratio = 0.3;
  io::write_bytes(small / "joint.toml", to_toml(request, small / ""));
  const JointRequest again = read_joint_request(small / "joint.toml");
  EXPECT_TRUE(fs::equivalent(again.labrum_mesh, request.labrum_mesh));
  const joint::JointModel model = read_joint_model(again, {});
  EXPECT_GT(model.labrum_body.n_tets(), 0);
  EXPECT_EQ(model.labrum_material.youngs_modulus, 33.0);
  EXPECT_EQ(model.labrum_material.poissons_ratio, 0.3);
  EXPECT_NE(error_of("[joint]\nlabrum_young_mpa = -1.0\n").find("labrum_young_mpa"),
            std::string::npos);
  EXPECT_NE(error_of("[joint]\nlabrum = \"hard\"\n").find("must be \"rigid\" or \"soft\""),
            std::string::npos);
  EXPECT_NE(error_of("[joint]\nvolume_change = \"nodes\"\n").find("\"patches\" or \"elements\""),
            std::string::npos);

  // the summary has as many cells as its header on every line
  joint::JointResult result;
  result.has_labrum_body = true;
  result.frames.resize(2);
  result.frames[0].status = joint::FrameStatus::converged;
  motion::HipMotion motion;
  motion.time = {0.0, 1.0};
  const std::string text = summary_csv(motion, result);
  EXPECT_NE(text.find(",force_on_labrum_N,labrum_pressure_p99_MPa,"), std::string::npos);
  std::vector<std::ptrdiff_t> commas{0};
  for (const char c : text) {
    if (c == ',') ++commas.back();
    if (c == '\n') commas.push_back(0);
  }
  EXPECT_EQ(commas[1], commas[0]);
  EXPECT_EQ(commas[2], commas[0]);
}
TEST(Ligaments, OfTheFileAreCheckedByKey) {
  EXPECT_NE(error_of("[joint]\nfriction = -0.1\n").find("friction must not be negative"),
            std::string::npos);
  EXPECT_NE(error_of("[joint]\nbare_bone = \"femur\"\n").find("must be \"hip_bone\" or \"both\""),
            std::string::npos);
  EXPECT_NE(error_of("[[joint.ligament]]\nname = \"a\"\n").find("origin_lps_mm"),
            std::string::npos);
  EXPECT_NE(error_of(kTable + "slack_lenght_mm = 3.0\n").find("did you mean slack_length_mm?"),
            std::string::npos);
}
TEST(Ligaments, LeaveNoTraceWhereThereAreNone) {
  const test::SmallRun small("no_ligament");
  JointRequest request;
  request.acetabular_cartilage = request.femoral_cartilage = request.motion = small / "mesh";
  const std::string text = to_toml(request, small / "");
  EXPECT_EQ(text.find("ligament"), std::string::npos);
  EXPECT_EQ(text.find("bare_bone"), std::string::npos);
}

}  // namespace
}  // namespace coxa::pipeline
