#include <coxa/pipeline/stage.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace coxa::pipeline {
namespace fs = std::filesystem;

class Stage : public ::testing::Test {
 protected:
  Stage()
      : folder_(fs::temp_directory_path() / ("coxa_stage_test_" + std::to_string(getpid())) /
                "mesh") {}
  ~Stage() override { fs::remove_all(folder_.parent_path()); }

  Record run(Reuse reuse = Reuse::if_unchanged, double edge = 1.5) {
    Record wanted;
    wanted.verb = "mesh";
    wanted.options["target_edge_mm"] = edge;
    wanted.inputs["surface"] = "abc";
    return run_stage(folder_, wanted, reuse, {}, [&](const fs::path& partial, Record& record) {
      ++runs_;
      io::write_bytes(partial / "result.txt", "content");
      record.figures["tets"] = std::int64_t{7};
      record.warnings.push_back("thin rim");
    });
  }

  fs::path folder_;
  int runs_ = 0;
};

TEST_F(Stage, LeavesItsResultAndItsRecord) {
  run();
  EXPECT_EQ(io::read_bytes(folder_ / "result.txt"), "content");
  const Record record = read_record(folder_ / "mesh.json");
  EXPECT_EQ(std::get<std::int64_t>(record.figures.at("tets")), 7);
  EXPECT_EQ(record.warnings, std::vector<std::string>{"thin rim"});
  EXPECT_FALSE(fs::exists(folder_.string() + ".partial"));
}
TEST_F(Stage, IsNotRunAgainWhileNothingChanged) {
  run();
  const Record again = run();
  EXPECT_EQ(runs_, 1);
  EXPECT_EQ(std::get<std::int64_t>(again.figures.at("tets")), 7);
}
TEST_F(Stage, IsRunAgainForAnotherOptionOrOnRequest) {
  run();
  run(Reuse::if_unchanged, 2.0);
  EXPECT_EQ(runs_, 2);
  run(Reuse::never, 2.0);
  EXPECT_EQ(runs_, 3);
}
TEST_F(Stage, IsRunAgainWhenItsRecordIsBroken) {
  run();
  io::write_bytes(folder_ / "mesh.json", "{");
  run();
  EXPECT_EQ(runs_, 2);
}
TEST_F(Stage, ThatFailsKeepsTheEarlierResultAndLeavesNothingHalfWritten) {
  run();
  Record wanted;
  wanted.verb = "mesh";
  const auto failing = [&] {
    run_stage(folder_, wanted, Reuse::never, {}, [&](const fs::path& partial, Record&) {
      io::write_bytes(partial / "half.txt", "half");
      fail(ErrorCode::bad_mesh, "hole");
    });
  };
  EXPECT_THROW(failing(), Error);
  EXPECT_EQ(io::read_bytes(folder_ / "result.txt"), "content");
  EXPECT_FALSE(fs::exists(folder_.string() + ".partial"));
}
TEST_F(Stage, StopsBeforeItBeginsOnceCancelled) {
  const std::atomic<bool> flag{true};
  Monitor monitor;
  monitor.cancel_flag = &flag;
  Record wanted;
  wanted.verb = "mesh";
  EXPECT_THROW(
      run_stage(folder_, wanted, Reuse::never, monitor, [&](const fs::path&, Record&) { ++runs_; }),
      Error);
  EXPECT_EQ(runs_, 0);
  EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(Stage, CancelledInItsLastMomentLeavesNothing) {
  std::atomic<bool> flag{false};
  Monitor monitor;
  monitor.cancel_flag = &flag;
  Record wanted;
  wanted.verb = "mesh";
  const auto body = [&](const fs::path& partial, Record&) {
    io::write_bytes(partial / "result.txt", "content");
    flag = true;
  };
  EXPECT_THROW(run_stage(folder_, wanted, Reuse::never, monitor, body), Error);
  EXPECT_FALSE(fs::exists(folder_));
  flag = false;
  EXPECT_THROW(run_file(folder_ / "a.vtu", wanted, monitor, body), Error);
  EXPECT_TRUE(fs::is_empty(folder_));
}
TEST_F(Stage, OfOneFileLeavesAllItsFilesAndTheRecordBesideThem) {
  Record wanted;
  wanted.verb = "track";
  wanted.options["side"] = std::string("left");
  const Record record =
      run_file(folder_ / "a.csv", wanted, {}, [](const fs::path& partial, Record& r) {
        io::write_bytes(partial / "a.csv", "motion");
        io::write_bytes(partial / "a_residuals.csv", "residuals");
        r.figures["frames"] = std::int64_t{3};
      });
  EXPECT_EQ(io::read_bytes(folder_ / "a.csv"), "motion");
  EXPECT_EQ(io::read_bytes(folder_ / "a_residuals.csv"), "residuals");
  const Record written = read_record(folder_ / "a.json");
  EXPECT_EQ(std::get<std::int64_t>(written.figures.at("frames")), 3);
  EXPECT_GT(written.peak_memory_mb, 0.0);
  EXPECT_EQ(written.seconds, record.seconds);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 3);
}
TEST_F(Stage, OfOneFileThatFailsKeepsTheEarlierFile) {
  io::write_bytes(folder_ / "a.csv", "earlier");
  const auto failing = [](const fs::path& partial, Record&) {
    io::write_bytes(partial / "a.csv", "half");
    fail(ErrorCode::bad_input, "no marker");
  };
  EXPECT_THROW(run_file(folder_ / "a.csv", {}, {}, failing), Error);
  EXPECT_EQ(io::read_bytes(folder_ / "a.csv"), "earlier");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

}  // namespace coxa::pipeline
