#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/markers.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <functional>

namespace coxa::io {
namespace fs = std::filesystem;

class Markers : public ::testing::Test {
 protected:
  Markers() : folder_(fs::temp_directory_path() / ("coxa_markers_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Markers() override { fs::remove_all(folder_); }
  static fs::path shared(const std::string& name) {
    return fs::path(COXA_SHARED_DIR) / "data" / name;
  }
  static std::string error_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_file);
      return error.what();
    }
    return "";
  }
  static bool warns(const motion::MarkerData& markers, const std::string& words) {
    for (const std::string& warning : markers.warnings) {
      if (warning.find(words) != std::string::npos) return true;
    }
    return false;
  }
  fs::path folder_;
};

#define SKIP_WITHOUT(path) \
  if (!fs::exists(path)) GTEST_SKIP() << "no file " << (path)

TEST_F(Markers, AreTheSameInAllSixEncodings) {
  SKIP_WITHOUT(shared("motion/c3d/Eb015pi.c3d"));
  const motion::MarkerData reference = read_markers(shared("motion/c3d/Eb015pi.c3d"));
  EXPECT_EQ(reference.n_markers(), 26);
  EXPECT_EQ(reference.n_frames(), 450);
  EXPECT_EQ(reference.rate, 50.0);
  EXPECT_EQ(reference.labels.front(), "RFT1");
  for (const char* encoding : {"pr", "vi", "vr", "si", "sr"}) {
    const auto other = read_markers(shared(std::string("motion/c3d/Eb015") + encoding + ".c3d"));
    EXPECT_EQ(other.labels, reference.labels);
    for (std::size_t m = 0; m < reference.trajectories.size(); ++m) {
      for (Index f = 0; f < 450; ++f) {
        ASSERT_EQ(motion::seen(other.trajectories[m], f),
                  motion::seen(reference.trajectories[m], f))
            << encoding;
        if (!motion::seen(reference.trajectories[m], f)) continue;
        // integers are multiples of 1/12 mm, reals were written with a float's 24 bits
        ASSERT_LE((other.trajectories[m].row(f) - reference.trajectories[m].row(f)).norm(), 1e-3)
            << encoding;
      }
    }
  }
}
TEST_F(Markers, OfEveryMakerAreRead) {
  struct Expected {
    const char* file;
    Index markers, frames;
    double rate;
  };
  for (const Expected& e :
       {Expected{"BKINtechnologies.c3d", 2, 5065, 1000},
        Expected{"FunctionalLHip.c3d", 74, 1577, 120},
        Expected{"FunctionalStatic.c3d", 104, 655, 120},
        Expected{"PiG_Calibration-FlatFoot-Hole.c3d", 177, 300, 100},
        Expected{"Sample_Static.c3d", 115, 275, 100}, Expected{"dynamic.C3D", 34, 296, 100},
        Expected{"squat.c3d", 53, 2539, 120}, Expected{"standing.C3D", 38, 200, 100},
        Expected{"type1.C3D", 28, 296, 100}, Expected{"bad_parameter_section.c3d", 45, 332, 120}}) {
    const fs::path path = shared("motion/c3d") / e.file;
    SKIP_WITHOUT(path);
    const auto markers = read_markers(path);
    EXPECT_EQ(markers.n_markers(), e.markers) << e.file;
    EXPECT_EQ(markers.n_frames(), e.frames) << e.file;
    EXPECT_EQ(markers.rate, e.rate) << e.file;
    for (const Points& trajectory : markers.trajectories) {
      for (const double x : trajectory.reshaped())
        ASSERT_TRUE(!std::isfinite(x) || std::abs(x) < 5000.0) << e.file;
    }
  }
}
TEST_F(Markers, ConvertMetresToMillimetres) {
  SKIP_WITHOUT(shared("motion/trc/STS1.trc"));
  const auto trc = read_markers(shared("motion/trc/STS1.trc"));
  EXPECT_EQ(trc.n_frames(), 1399);
  EXPECT_EQ(trc.labels.at(1), "L.ASIS");
  EXPECT_NEAR(trc.trajectories[0](0, 0), -745.392, 1e-9);
  const auto c3d = read_markers(shared("motion/c3d/BKINtechnologies.c3d"));
  EXPECT_NEAR(c3d.trajectories[0](0, 1), 651.37, 0.01);
}
TEST_F(Markers, OfABrokenParameterSectionComeWithWarnings) {
  SKIP_WITHOUT(shared("motion/c3d/bad_parameter_section.c3d"));
  const auto markers = read_markers(shared("motion/c3d/bad_parameter_section.c3d"));
  EXPECT_TRUE(warns(markers, "parameter section is broken at byte"));
  EXPECT_TRUE(markers.events.empty());
  EXPECT_EQ(markers.labels.front(), "P1");
}
TEST_F(Markers, KeepEventsAndLeaveComputedOutputsOut) {
  SKIP_WITHOUT(shared("mri/one_patient/gait.c3d"));
  const auto markers = read_markers(shared("mri/one_patient/gait.c3d"));
  ASSERT_EQ(markers.events.size(), 8u);
  EXPECT_EQ(markers.events.front().label, "Foot Strike");
  EXPECT_EQ(markers.events.front().context, "Right");
  EXPECT_NEAR(markers.events.front().time, 4.72685, 1e-4);
  EXPECT_NEAR(markers.first_time, 544.0 / 120.0, 1e-9);
  EXPECT_FALSE(motion::find_marker(markers, "LHipAngles"));
  EXPECT_TRUE(motion::find_marker(markers, "lasi"));
  EXPECT_TRUE(warns(markers, "36 computed"));
}
TEST_F(Markers, StandTwiceUnderNamesOfTheirOwn) {
  SKIP_WITHOUT(shared("motion/c3d/dynamic.C3D"));
  const auto markers = read_markers(shared("motion/c3d/dynamic.C3D"));
  EXPECT_TRUE(motion::find_marker(markers, "r asis_2"));
  EXPECT_TRUE(warns(markers, "names no unit; its size says mm"));
}
TEST_F(Markers, OfAFileCutShortAreReadToItsEnd) {
  SKIP_WITHOUT(shared("motion/c3d/Eb015pi.c3d"));
  const std::string bytes = read_bytes(shared("motion/c3d/Eb015pi.c3d"));
  write_bytes(folder_ / "short.c3d", bytes.substr(0, bytes.size() / 2));
  const auto markers = read_markers(folder_ / "short.c3d");
  EXPECT_GT(markers.n_frames(), 200);
  EXPECT_LT(markers.n_frames(), 230);
  EXPECT_TRUE(warns(markers, "cut short"));
  write_bytes(folder_ / "shorter.c3d", bytes.substr(0, 5200));
  EXPECT_NE(
      error_of([&] { read_markers(folder_ / "shorter.c3d"); }).find("ends before its first frame"),
      std::string::npos);
}
TEST_F(Markers, OfDamagedFilesNeverCrashTheReader) {
  SKIP_WITHOUT(shared("motion/c3d/Eb015sr.c3d"));
  const std::string bytes = read_bytes(shared("motion/c3d/Eb015sr.c3d"));
  for (std::size_t at = 0; at < 5120; at += 37) {
    std::string damaged = bytes.substr(0, 60000);
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
    write_bytes(folder_ / "damaged.c3d", damaged);
    try {
      read_markers(folder_ / "damaged.c3d");
    } catch (const Error&) {
      // refused with a reason: as good as read
    }
  }
}
TEST_F(Markers, RefuseWhatIsNoC3d) {
  write_bytes(folder_ / "x.c3d", std::string(2000, 'x'));
  EXPECT_NE(error_of([&] { read_markers(folder_ / "x.c3d"); }).find("not a C3D file"),
            std::string::npos);
  EXPECT_NE(error_of([&] { read_markers(folder_ / "none.c3d"); }), "");
  write_bytes(folder_ / "x.txt", "x");
  EXPECT_NE(error_of([&] { read_markers(folder_ / "x.txt"); }).find(".c3d, .trc or .csv"),
            std::string::npos);
  std::string header(1024, '\0');
  header[0] = 2;
  header[1] = 0x50;
  header[512 + 3] = 99;
  write_bytes(folder_ / "y.c3d", header);
  EXPECT_NE(error_of([&] { read_markers(folder_ / "y.c3d"); }).find("unknown processor 99"),
            std::string::npos);
}
TEST_F(Markers, ReturnFromTrcAndCsv) {
  motion::MarkerData markers;
  markers.labels = {"A", "B"};
  markers.rate = 50.0;
  markers.first_time = 0.5;
  markers.trajectories.assign(2, Points::Random(7, 3) * 500.0);
  markers.trajectories[1].row(3).setConstant(kNaN);
  write_trc(folder_ / "m.trc", markers);
  write_markers_csv(folder_ / "m.csv", markers);
  for (const char* file : {"m.trc", "m.csv"}) {
    const auto back = read_markers(folder_ / file);
    EXPECT_EQ(back.labels, markers.labels);
    EXPECT_NEAR(back.rate, 50.0, 1e-6);
    EXPECT_NEAR(back.first_time, 0.5, 1e-9);
    EXPECT_FALSE(motion::seen(back.trajectories[1], 3));
    EXPECT_LE((back.trajectories[0] - markers.trajectories[0]).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_TRUE(back.warnings.empty());
  }
}
TEST_F(Markers, OfBrokenTrcNameTheLine) {
  const std::string head =
      "PathFileType\t4\t(X/Y/Z)\tm.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t1\t1\t";
  write_bytes(folder_ / "a.trc",
              head + "mm\nFrame#\tTime\tA\n\t\tX1\tY1\tZ1\n1\t0.0\t1.0\tabc\t2.0\n");
  EXPECT_NE(error_of([&] {
              read_markers(folder_ / "a.trc");
            }).find("line 6: a coordinate should be a number, but is 'abc'"),
            std::string::npos);
  write_bytes(folder_ / "b.trc",
              head + "furlong\nFrame#\tTime\tA\n\t\tX1\tY1\tZ1\n1\t0.0\t1.0\t3\t2.0\n");
  EXPECT_NE(error_of([&] { read_markers(folder_ / "b.trc"); }).find("'furlong'"),
            std::string::npos);
  write_bytes(folder_ / "c.trc", head + "mm\nFrame#\tTime\tA\n\t\tX1\tY1\tZ1\n\n");
  EXPECT_NE(error_of([&] { read_markers(folder_ / "c.trc"); }).find("no frame"), std::string::npos);
  write_bytes(folder_ / "d.csv", "time_s,A_x_mm,A_y_mm\n0,1,2\n");
  EXPECT_NE(error_of([&] { read_markers(folder_ / "d.csv"); }).find("no column 'A_z_mm'"),
            std::string::npos);
}

}  // namespace coxa::io
