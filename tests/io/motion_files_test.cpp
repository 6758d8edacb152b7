#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/motion_files.h>
#include <coxa/io/movement_files.h>
#include <coxa/io/track_config.h>
#include <coxa/io/track_model.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace coxa::io {
namespace fs = std::filesystem;

class MotionFiles : public ::testing::Test {
 protected:
  MotionFiles() : folder_(fs::temp_directory_path() / ("coxa_motion_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~MotionFiles() override { fs::remove_all(folder_); }
  fs::path folder_;
};

std::string error_text(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

motion::HipModel some_model() {
  motion::HipModel model;
  model.side = Side::left;
  model.joint_centre_pelvis = Vec3(-20, -80, -85);
  model.joint_centre_femur = Vec3(1, 2, 3);
  model.pelvis_markers = {{"A", Vec3(1, 0, 0)}, {"B", Vec3(0, 100, 0)}, {"C", Vec3(0, 0, 100)}};
  model.thigh_markers = {
      {"D", Vec3(50, -100, 0)}, {"E", Vec3(0, -200, 50)}, {"F", Vec3(-50, -300, 0)}};
  model.calibration_frame = 4;
  model.marker_sd = 2.0;
  model.source = "test";
  return model;
}

TEST_F(MotionFiles, MovementReturnsFromCsv) {
  const auto pattern =
      motion::simple_pattern("test", {}, {radians(90), radians(-10), radians(20)}, 1.0);
  auto motion = motion::make_movement(pattern, Side::left, {.rate = 20});
  motion.interval.assign(motion.angles.size(), {0.01, 0.02, 0.03});
  motion.warnings = {"first", "second\nline"};
  motion.X_PF[3].p = Vec3(0.1, 0.2, 0.3);
  motion.head_lab = Points::Random(motion.n_frames(), 3) * 1000.0;
  write_motion(folder_ / "m.csv", motion);
  const auto back = read_motion(folder_ / "m.csv", Side::left);
  ASSERT_EQ(back.n_frames(), motion.n_frames());
  EXPECT_EQ(back.method, motion.method);
  EXPECT_EQ(back.warnings.at(1), "second line");
  EXPECT_LE((back.head_lab - motion.head_lab).cwiseAbs().maxCoeff(), 1e-6);
  for (std::size_t f = 0; f < motion.angles.size(); ++f) {
    EXPECT_NEAR(back.angles[f].internal_rotation, motion.angles[f].internal_rotation, 1e-9);
    EXPECT_NEAR(back.interval[f].adduction, 0.02, 1e-9);
    EXPECT_LE((back.X_PF[f].R - motion.X_PF[f].R).norm(), 1e-8);
    EXPECT_LE((back.X_PF[f].p - motion.X_PF[f].p).norm(), 1e-8);
  }
}
TEST_F(MotionFiles, MovementCsvNamesWhatIsMissing) {
  write_bytes(folder_ / "m.csv", "time_s,flexion_deg\n0,1\n");
  EXPECT_NE(error_text([&] {
              read_motion(folder_ / "m.csv", Side::left);
            }).find("no column 'adduction_deg'"),
            std::string::npos);
  write_bytes(folder_ / "m.csv",
              "time_s,flexion_deg,adduction_deg,internal_rotation_deg\n0,1,2,3\n0,1,2,3\n");
  EXPECT_NE(error_text([&] {
              read_motion(folder_ / "m.csv", Side::left);
            }).find("line 3: time_s does not increase"),
            std::string::npos);
}
TEST_F(MotionFiles, OpensimMotionHasOneRowPerFrame) {
  const auto motion = motion::make_movement(motion::simple_pattern("test", {}, {radians(90)}, 1.0),
                                            Side::right, {.n_frames = 3});
  write_opensim_motion(folder_ / "m.mot", motion, Side::right);
  const std::string text = read_bytes(folder_ / "m.mot");
  EXPECT_NE(text.find("nRows=3"), std::string::npos);
  EXPECT_NE(
      text.find("time\thip_flexion_r\thip_adduction_r\thip_rotation_r\n0\t0\t0\t0\n0.5\t45\t"),
      std::string::npos)
      << text;
}
TEST_F(MotionFiles, HipModelReturnsFromJson) {
  const auto model = some_model();
  write_hip_model(folder_ / "m.json", model);
  const auto back = read_hip_model(folder_ / "m.json");
  EXPECT_EQ(back.side, model.side);
  EXPECT_EQ(back.calibration_frame, model.calibration_frame);
  EXPECT_EQ(back.thigh_markers.at("E"), model.thigh_markers.at("E"));
  EXPECT_EQ(back.joint_centre_pelvis, model.joint_centre_pelvis);
  EXPECT_EQ(back.marker_sd, 2.0);
}
TEST_F(MotionFiles, HipModelNamesTheKeyThatIsWrong) {
  write_bytes(folder_ / "m.json", R"({"joint_centre_pelvis_mm": [1, 2]})");
  EXPECT_NE(error_text([&] {
              read_hip_model(folder_ / "m.json");
            }).find("'joint_centre_pelvis_mm' must be three numbers"),
            std::string::npos);
  write_bytes(folder_ / "m.json", "{");
  EXPECT_NE(error_text([&] { read_hip_model(folder_ / "m.json"); }).find("not a JSON object"),
            std::string::npos);
}
TEST_F(MotionFiles, EventsAreWrittenInTheOrderOfTime) {
  write_events(folder_ / "e.csv",
               {{"Foot Off", "Right", 1.25}, {"Foot Strike, first", "Left", 0.5}});
  EXPECT_EQ(read_bytes(folder_ / "e.csv"),
            "time_s,label,context,source\n0.5,Foot Strike  first,Left,recording\n"
            "1.25,Foot Off,Right,recording\n");
}
TEST_F(MotionFiles, GaitRepeatsAfterItsCycle) {
  const auto pattern = read_pattern(fs::path(COXA_SOURCE_DIR) / "data" / "movements" / "gait.toml");
  const auto motion = motion::make_movement(pattern, Side::right, {.rate = 100, .cycles = 2});
  ASSERT_EQ(motion.n_frames(), 201);
  for (std::size_t f = 0; f <= 100; ++f)
    EXPECT_NEAR(motion.angles[f].flexion, motion.angles[f + 100].flexion, 1e-9);
  // no corner where the cycle closes: speed just before and just after it
  const double before = motion.angles[100].flexion - motion.angles[99].flexion;
  const double after = motion.angles[101].flexion - motion.angles[100].flexion;
  EXPECT_NEAR(before, after, radians(0.1));
}
TEST_F(MotionFiles, EveryShippedPatternIsReadAndReturns) {
  int count = 0;
  for (const auto& entry :
       fs::directory_iterator(fs::path(COXA_SOURCE_DIR) / "data" / "movements")) {
    const auto pattern = read_pattern(entry.path());
    EXPECT_EQ(pattern.name, entry.path().stem().string());
    EXPECT_FALSE(pattern.source.empty());
    EXPECT_GE(motion::make_movement(pattern, Side::right).n_frames(), 10);
    write_pattern(folder_ / "p.toml", pattern);
    const auto back = read_pattern(folder_ / "p.toml");
    ASSERT_EQ(back.poses.size(), pattern.poses.size());
    EXPECT_NEAR(back.poses.back().angles.flexion, pattern.poses.back().angles.flexion, 1e-6);
    ++count;
  }
  EXPECT_GE(count, 12);
}
TEST_F(MotionFiles, PatternNamesTheKeyThatIsWrong) {
  write_bytes(folder_ / "p.toml",
              "name = \"x\"\ntime_s = [0, 1]\nflexion_deg = [0]\nadduction_deg = [0, "
              "0]\ninternal_rotation_deg = [0, 0]\n");
  EXPECT_NE(error_text([&] {
              read_pattern(folder_ / "p.toml");
            }).find("flexion_deg has 1 values, time_s has 2"),
            std::string::npos);
  write_bytes(folder_ / "p.toml",
              "name = \"x\"\ntime_s = [0, 1]\nflexion_deg = [0, 9]\nadduction_deg = [0, "
              "0]\ninternal_rotation_deg = [0, 0]\nflexon_deg = 3\n");
  EXPECT_NE(error_text([&] { read_pattern(folder_ / "p.toml"); }).find("flexon_deg"),
            std::string::npos);
}
TEST_F(MotionFiles, TrackConfigReadsEveryKey) {
  write_hip_model(folder_ / "model.json", some_model());
  write_bytes(folder_ / "c.toml", R"(
side = "left"
model_file = "model.json"
method = "rigid"
first_frame = 11
last_frame = 20
[labels]
"file label" = "D"
[cleaning]
longest_gap_s = 0.5
longest_curve_s = 0.2
jump_mm = 30.0
cutoff_hz = 6.0
[errors]
measurement_sd_mm = 1.0
joint_translation_sd_mm = 2.0
common_rotation_share = 0.3
[calibration]
trial = "static.c3d"
first_frame = 2
last_frame = 9
joint_centre = "score"
joint_centre_pelvis_mm = [1.0, 2.0, 3.0]
joint_centre_sd_mm = 1.5
knee_half_width_mm = 50.0
marker_sd_mm = 4.0
[marker_map]
thigh = ["X#"]
)");
  const TrackConfig config = read_track_config(folder_ / "c.toml");
  const motion::TrackSetup& setup = config.setup;
  EXPECT_EQ(setup.side, Side::left);
  EXPECT_EQ(setup.model->marker_sd, 2.0);
  EXPECT_EQ(setup.track.method, motion::PoseMethod::rigid);
  EXPECT_EQ(setup.first_frame, 10);
  EXPECT_EQ(setup.end_frame, 20);
  EXPECT_EQ(setup.rename.at("file label"), "D");
  EXPECT_EQ(setup.cleaning.longest_gap, 0.5);
  EXPECT_EQ(setup.cleaning.longest_curve, 0.2);
  EXPECT_EQ(setup.cleaning.jump, 30.0);
  EXPECT_EQ(setup.cleaning.cutoff_hz, 6.0);
  EXPECT_EQ(setup.track.measurement_sd, 1.0);
  EXPECT_EQ(setup.track.joint_translation_sd, 2.0);
  EXPECT_EQ(setup.track.common_rotation_share, 0.3);
  EXPECT_EQ(config.neutral_trial, folder_ / "static.c3d");
  EXPECT_EQ(setup.calibration.first_frame, 1);
  EXPECT_EQ(setup.calibration.end_frame, 9);
  EXPECT_EQ(setup.calibration.centre, motion::CentreSource::score);
  EXPECT_EQ(setup.calibration.joint_centre_pelvis->y(), 2.0);
  EXPECT_EQ(setup.calibration.joint_centre_sd, 1.5);
  EXPECT_EQ(setup.calibration.knee_half_width, 50.0);
  EXPECT_EQ(setup.calibration.marker_sd, 4.0);
  EXPECT_EQ(setup.calibration.map.at(motion::MarkerRole::thigh).front(), "X#");
}
TEST_F(MotionFiles, TrackConfigTakesAModelTableAndRefusesMisspeltKeys) {
  write_bytes(folder_ / "c.toml", R"(
[model]
joint_centre_pelvis_mm = [1, 2, 3]
joint_centre_femur_mm = [0, 0, 0]
calibration_frame = 1
[model.pelvis_markers]
A = [0, 0, 0]
[model.thigh_markers]
B = [0, 1, 0]
)");
  EXPECT_EQ(read_track_config(folder_ / "c.toml").setup.model->thigh_markers.at("B").y(), 1.0);
  write_bytes(folder_ / "c.toml", "methd = \"rigid\"\n");
  EXPECT_NE(error_text([&] { read_track_config(folder_ / "c.toml"); }).find("method"),
            std::string::npos);
  write_bytes(folder_ / "c.toml", "method = \"magic\"\n");
  EXPECT_NE(error_text([&] { read_track_config(folder_ / "c.toml"); }).find("ball_joint_ml"),
            std::string::npos);
}

}  // namespace coxa::io
