#include <coxa/io/surfaces.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <coxa/pipeline/mesh_stage.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <filesystem>

namespace coxa::pipeline {
namespace {
namespace fs = std::filesystem;

class MeshFile : public testing::Test {
 protected:
  MeshFile()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("mesh_file_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~MeshFile() override { fs::remove_all(folder_); }

  Record run(const TriMesh& surface) {
    io::write_surface(folder_ / "body.ply", surface);
    MeshRequest request;
    request.surface = folder_ / "body.ply";
    request.options = {.max_tets = 2000, .improvement_rounds = 1};
    return run_mesh_file(request, folder_ / "body.vtu", {});
  }

  fs::path folder_;
};

TEST_F(MeshFile, ShowsWhatASurfaceWasRepairedTo) {
  const TriMesh ball = test::icosphere(3, 10.0);
  TriMesh open = ball;
  open.triangles = ball.triangles.topRows(ball.n_triangles() - 1).eval();
  EXPECT_FALSE(run(open).warnings.empty());
  const TriMesh repaired = io::read_surface(folder_ / "body_repaired.ply");
  EXPECT_EQ(manifold_fault(repaired), "");
  EXPECT_NEAR(volume(repaired), volume(ball), 1e-3 * volume(ball));
}

TEST_F(MeshFile, WritesNoOtherSurfaceWhereNoneWasNeeded) {
  run(test::icosphere(3, 10.0));
  EXPECT_TRUE(fs::exists(folder_ / "body.vtu"));
  EXPECT_FALSE(fs::exists(folder_ / "body_repaired.ply"));
}

}  // namespace
}  // namespace coxa::pipeline
