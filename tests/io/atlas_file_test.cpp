#include <coxa/io/atlas_file.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/mesh/hierarchy.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "support/shapes.h"

namespace coxa::io {
namespace {

namespace fs = std::filesystem;

fs::path place(const std::string& name) {
  return fs::temp_directory_path() / ("coxa_atlas_" + std::to_string(getpid()) + "_" + name);
}

shape::Atlas small_atlas() {
  shape::StructureModel model;
  model.name = "femur";
  model.hierarchy = make_hierarchy(test::icosphere(3), {.n_levels = 2});
  const SimplexMesh& finest = model.hierarchy.levels.back();
  for (Index v = 0; v < finest.n_vertices(); ++v) {
    const auto corner = [&](int k) { return Vec3(finest.points.row(finest.neighbours(v, k))); };
    model.reference.push_back(
        simplex_parameters(finest.points.row(v), corner(0), corner(1), corner(2)));
  }
  model.shape.modes = MatX::Random(3 * finest.n_vertices(), 2);
  for (int c = 0; c < 2; ++c) model.shape.modes.col(c).normalize();
  model.shape.deviations = Vec2(3.0, 1.5);
  model.profiles.push_back({"t1", 0.5, 2, MatX::Random(finest.n_vertices(), 5),
                            VecX::Constant(finest.n_vertices(), 0.5)});
  model.landmark_vertices["femoral_shaft_distal"] = 7;
  model.n_bone_side = 3;
  model.muscle = true;
  model.leave_one_out_error = 0.25;
  return {{model}, {{"femoral_head_centre", Vec3(1, 2, 3)}}, {"toy/1"}, "mine"};
}

TEST(AtlasFile, GivesBackWhatWasWritten) {
  const shape::Atlas written = small_atlas();
  const fs::path path = place("whole");
  write_atlas(path, written);
  const shape::Atlas read = read_atlas(path);
  fs::remove(path);
  EXPECT_EQ(read.attribution, "mine");
  EXPECT_EQ(read.subjects, written.subjects);
  EXPECT_EQ(read.landmarks, written.landmarks);
  ASSERT_EQ(read.structures.size(), 1u);
  const shape::StructureModel &a = written.structures[0], &b = read.structures[0];
  ASSERT_EQ(b.hierarchy.levels.size(), a.hierarchy.levels.size());
  const SimplexMesh &fine = a.hierarchy.levels.back(), &again = b.hierarchy.levels.back();
  EXPECT_EQ(again.neighbours, fine.neighbours);
  EXPECT_LT((again.points - fine.points).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((b.shape.modes - a.shape.modes).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_EQ(b.shape.deviations, a.shape.deviations);
  EXPECT_LT((b.profiles[0].mean - a.profiles[0].mean).cwiseAbs().maxCoeff(), 1.0 / 200.0);
  EXPECT_EQ(b.profiles[0].n_inside, 2);
  EXPECT_NEAR(b.reference[5].height, a.reference[5].height, 1e-4);
  EXPECT_EQ(b.landmark_vertices, a.landmark_vertices);
  EXPECT_EQ(b.n_bone_side, 3);
  EXPECT_TRUE(b.muscle);
  EXPECT_FALSE(b.generic);
  EXPECT_EQ(b.leave_one_out_error, 0.25);
}

TEST(AtlasFile, RefusesWhatIsNotAWholeAtlas) {
  const fs::path path = place("broken");
  EXPECT_THROW(read_atlas(path), Error);
  write_bytes(path, "not an atlas at all");
  EXPECT_THROW(read_atlas(path), Error);
  write_atlas(path, small_atlas());
  const std::string bytes = read_bytes(path);
  write_bytes(path, std::string_view(bytes).substr(0, bytes.size() / 2));
  try {
    read_atlas(path);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_file);
    EXPECT_NE(std::string(error.what()).find(path.filename().string()), std::string::npos);
  }
  fs::remove(path);
}

}  // namespace
}  // namespace coxa::io
