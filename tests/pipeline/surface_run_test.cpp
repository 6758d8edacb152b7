#include <coxa/pipeline/run.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/tets.h>
#include <coxa/pipeline/mesh_stage.h>
#include <coxa/pipeline/record.h>
#include <coxa/pipeline/surface_stage.h>
#include <gtest/gtest.h>

#include "pipeline/small_run.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;

const char* const kNames[] = {"femur", "hip_bone", "femoral_cartilage", "acetabular_cartilage"};

/// A subject file beside the small hip's surfaces that takes them in place of an image.
fs::path subject_of(const test::SmallRun& small, const std::string& joint) {
  std::string text = "side = \"right\"\nbody_mass_kg = 60.0\n[surfaces]\n";
  for (const std::string name : kNames) text += name + " = \"segment/" + name + ".vtp\"\n";
  text += "[motion]\npattern = \"flexion\"\nframes = 2\n" + joint;
  io::write_bytes(small / "given.toml", text);
  return small / "given.toml";
}

TEST(SurfaceRun, GoesFromGivenSurfacesToTheReport) {
  const test::SmallRun small("surface_run");
  const Subject subject = read_subject(subject_of(
      small,
      "[joint]\nloading = \"body_weight\"\npercent_body_weight = 50\nbare_bone = \"both\"\n"
      "[[joint.ligament]]\nname = \"band\"\norigin_lps_mm = [0, 0, 40]\n"
      "insertion_lps_mm = [0, 0, -20]\nstiffness_N_per_mm = 4\nslack_length_mm = 50\n"));
  const auto records = run_subject(subject, small / "out", {}, {});
  ASSERT_EQ(records.size(), 5U);
  EXPECT_EQ(records[0].verb, "segment");
  EXPECT_GT(std::get<double>(records[0].figures.at("femur_volume_mm3")), 0.0);
  // 50 % of 60 kg times 9.80665 m/s2
  EXPECT_NE(std::get<std::string>(records[3].figures.at("load")).find("294.2 N"), std::string::npos)
      << std::get<std::string>(records[3].figures.at("load"));
  EXPECT_GE(std::get<std::int64_t>(records[3].figures.at("frames_converged")), 1);
  // 60 mm long in the image pose
  EXPECT_GT(std::get<double>(records[3].figures.at("largest_tension_band_N")), 20.0);
  EXPECT_EQ(records[3].figures.count("largest_share_of_bare_femur_percent"), 1U);
  EXPECT_TRUE(fs::exists(small / "out" / "report" / "report.html"));
  EXPECT_FALSE(fs::exists(small / "out" / "report" / "slices.png"));

  // the maxima over time are those of the frames' files
  const fs::path joint = small / "out" / "joint";
  for (const std::string body : {"acetabular", "femoral"}) {
    const auto most = io::read_tets_with_fields(joint / ("maxima_" + body + ".vtu")).fields;
    MatX pressure, stress;
    for (const auto& entry : fs::directory_iterator(joint / "frames")) {
      if (entry.path().filename().string().find(body) != 0) continue;
      const auto frame = io::read_tets_with_fields(entry.path()).fields;
      const MatX &p = frame.at_points.at("contact_pressure_MPa"),
                 &s = frame.at_tets.at("von_mises_MPa");
      pressure = pressure.size() == 0 ? p : MatX(pressure.cwiseMax(p));
      stress = stress.size() == 0 ? s : MatX(stress.cwiseMax(s));
    }
    EXPECT_GT(pressure.maxCoeff(), 0.0);
    EXPECT_EQ(most.at_points.at("contact_pressure_MPa"), pressure);
    EXPECT_EQ(most.at_tets.at("von_mises_MPa"), stress);
    EXPECT_GT(most.at_tets.at("compression").maxCoeff(), 0.0);
  }
}

TEST(SurfaceRun, MakesABodyOfTheLabrumAndGivesItToTheJointWhereItIsAskedFor) {
  const test::SmallRun small("surface_run_labrum");
  // a rind on the outside of the socket's bone, which the femur does not reach
  const double outside = test::kSocketRadius + 8.0;
  io::write_surface(
      small / "segment/acetabular_labrum.vtp",
      test::surface_of(test::cap_shell(outside + 2.0, outside + 0.1, radians(25.0), 5, 1)));
  const fs::path mesh = small / "mesh_with_labrum";
  const Record record =
      run_mesh_stage(small / "segment", {.max_tets = 6000}, mesh, Reuse::never, {});
  ASSERT_TRUE(fs::exists(mesh / "acetabular_labrum.vtu"))
      << (record.warnings.empty() ? "" : record.warnings.back());
  const TetMesh body = io::read_tets(mesh / "acetabular_labrum.vtu");
  EXPECT_GT(body.n_tets(), 50);
  EXPECT_LE(body.n_tets(), 4000);
  EXPECT_GT(joint::facets_with(body, FacetTag::bone_side).rows(), 0);
  EXPECT_EQ(std::get<std::int64_t>(record.figures.at("acetabular_labrum_tets")), body.n_tets());

  // asked for where there is none
  try {
    run_subject(read_subject(subject_of(small, "[joint]\nlabrum = \"soft\"\n")), small / "out", {},
                {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("structures does not name the labrum"),
              std::string::npos)
        << error.what();
  }
}
TEST(SurfaceRun, NamesTheStructureThatCannotBeUsed) {
  const test::SmallRun small("surface_run_bad");
  TriMesh open = io::read_surface(small / "segment/femur.vtp");
  open.triangles.conservativeResize(open.n_triangles() / 2, 3);
  io::write_surface(small / "segment/femur.vtp", open);
  const Subject subject = read_subject(subject_of(small, ""));
  try {
    run_surface_stage({subject.surfaces, subject.side}, small / "out", Reuse::never, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_mesh);
    EXPECT_EQ(std::string(error.what()).find("femur ("), 0U) << error.what();
  }
  EXPECT_FALSE(fs::exists(small / "out"));
}

}  // namespace coxa::pipeline
