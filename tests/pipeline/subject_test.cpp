#include <coxa/pipeline/subject.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace coxa::pipeline {
namespace fs = std::filesystem;

class SubjectFile : public ::testing::Test {
 protected:
  SubjectFile()
      : folder_(fs::temp_directory_path() / ("coxa_subject_" + std::to_string(getpid()))) {
    io::write_bytes(folder_ / "t1.nii.gz", "image");
    io::write_bytes(folder_ / "places.mrk.json", "landmarks");
  }
  ~SubjectFile() override { fs::remove_all(folder_); }

  Subject read(const std::string& text) {
    io::write_bytes(folder_ / "subject.toml", text);
    return read_subject(folder_ / "subject.toml");
  }
  std::string error_of(const std::string& text) {
    try {
      read(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_input);
      return error.what();
    }
    return "no error";
  }
  const std::string good_ =
      "side = \"left\"\n[image]\npath = \"t1.nii.gz\"\n[landmarks]\npath = \"places.mrk.json\"\n"
      "[motion]\npattern = \"flexion\"\n";
  fs::path folder_;
};

TEST_F(SubjectFile, GivesItsValuesAndDefaults) {
  const Subject s = read(good_ + "frames = 7\n[joint]\nforce_N = 800\n");
  EXPECT_EQ(s.side, Side::left);
  EXPECT_EQ(s.name, "subject");
  EXPECT_EQ(s.images.at(0).path, folder_ / "t1.nii.gz");
  EXPECT_EQ(s.motion.frames, 7);
  EXPECT_DOUBLE_EQ(s.joint.force, 800.0);
  EXPECT_DOUBLE_EQ(s.joint.poisson_ratio, 0.42);
  EXPECT_EQ(s.joint.loading, Loading::joint_force);
}
TEST_F(SubjectFile, FindsAMovementFileBesideItAndNeverTakesAFolderForOne) {
  fs::create_directory(folder_ / "flexion");
  EXPECT_EQ(read(good_).motion.pattern, "flexion");
  io::write_bytes(folder_ / "mine.toml", "movement");
  EXPECT_EQ(
      read("side = \"left\"\n[image]\npath = \"t1.nii.gz\"\n[motion]\npattern = \"mine.toml\"\n")
          .motion.pattern,
      (folder_ / "mine.toml").string());
}
TEST_F(SubjectFile, NamesItsStructuresAndEditedLabels) {
  EXPECT_TRUE(read(good_).structures.empty());
  const Subject s = read("structures = \"labrum\"\n" + good_ + "[labels]\npath = \"t1.nii.gz\"\n");
  EXPECT_EQ(s.structures, (std::vector<std::string>{"femur", "hip_bone", "femoral_cartilage",
                                                    "acetabular_cartilage", "acetabular_labrum"}));
  EXPECT_EQ(s.labels, folder_ / "t1.nii.gz");
}
TEST_F(SubjectFile, NamesItsPins) {
  EXPECT_EQ(read(good_).pins, fs::path());
  EXPECT_EQ(read(good_ + "[pins]\npath = \"places.mrk.json\"\n").pins, folder_ / "places.mrk.json");
  EXPECT_NE(error_of(good_ + "[pins]\npath = \"none.mrk.json\"\n").find("there is no"),
            std::string::npos);
}
TEST_F(SubjectFile, NamesTheNearestKeyOfAMisspeltOne) {
  EXPECT_NE(error_of(good_ + "[joint]\nforce_n = 800\n").find("did you mean force_N?"),
            std::string::npos);
}
TEST_F(SubjectFile, NamesAFileThatIsNotThere) {
  const std::string text =
      error_of("side = \"left\"\n[image]\npath = \"t2.nii.gz\"\n[motion]\npattern = \"flexion\"\n");
  EXPECT_NE(text.find("there is no"), std::string::npos);
  EXPECT_NE(text.find("t2.nii.gz"), std::string::npos);
}
TEST_F(SubjectFile, WantsEitherAPatternOrMarkers) {
  EXPECT_NE(error_of(good_ + "markers = \"t1.nii.gz\"\n").find("either a pattern or markers"),
            std::string::npos);
}
TEST_F(SubjectFile, TakesAPartOfARecordingButNotOfAPattern) {
  const std::string recorded =
      "side = \"left\"\n[image]\npath = \"t1.nii.gz\"\n[motion]\nmarkers = \"t1.nii.gz\"\n";
  EXPECT_DOUBLE_EQ(*read(recorded + "from_s = 0.5\nto_s = 2\n").motion.to, 2.0);
  EXPECT_NE(error_of(recorded + "from_s = 2\nto_s = 1\n").find("later than"), std::string::npos);
  EXPECT_NE(error_of(good_ + "from_s = 1\n").find("simulated whole"), std::string::npos);
}
TEST_F(SubjectFile, RefusesValuesOutOfRange) {
  EXPECT_NE(error_of(good_ + "[joint]\npoisson = 0.5\n").find("must be in (0, 0.5), got 0.5"),
            std::string::npos);
  EXPECT_NE(error_of(good_ + "[mesh]\nlayers = 9\n").find("must be 1 to 8, got 9"),
            std::string::npos);
  EXPECT_NE(error_of(good_ + "frames = 1\n").find("must be 2 to 2000, got 1"), std::string::npos);
}
TEST_F(SubjectFile, TakesSurfacesInPlaceOfAnImageAndNotBeside) {
  std::string surfaces = "[surfaces]\n";
  for (const std::string name :
       {"femur", "hip_bone", "femoral_cartilage", "acetabular_cartilage"}) {
    io::write_bytes(folder_ / (name + ".ply"), "surface");
    surfaces += name + " = \"" + name + ".ply\"\n";
  }
  const std::string motion = "[motion]\npattern = \"flexion\"\n";
  const Subject s = read("side = \"left\"\n" + surfaces + motion);
  EXPECT_EQ(s.surfaces.at("hip_bone"), folder_ / "hip_bone.ply");
  EXPECT_TRUE(s.images.empty());
  EXPECT_NE(error_of(good_ + surfaces).find("not both"), std::string::npos);
  EXPECT_NE(error_of("side = \"left\"\n" + motion).find("[surfaces]"), std::string::npos);
}
TEST_F(SubjectFile, TakesALoadInPercentOfBodyWeight) {
  const std::string load =
      "[joint]\nloading = \"body_weight\"\npercent_body_weight = 233\ndirection = [0, 1, 0]\n";
  const Subject s = read("body_mass_kg = 70\n" + good_ + load);
  EXPECT_EQ(s.joint.loading, Loading::body_weight);
  EXPECT_DOUBLE_EQ(s.joint.percent, 233.0);
  EXPECT_EQ(*s.joint.direction, Vec3(0, 1, 0));
  EXPECT_NE(error_of(good_ + load).find("body_mass_kg"), std::string::npos);
  EXPECT_NE(error_of(good_ + "[joint]\npercent_body_weight = 233\n").find("left out otherwise"),
            std::string::npos);
}
TEST_F(SubjectFile, TakesALoadMeasuredInVivoByItsActivity) {
  const std::string load = "[joint]\nloading = \"body_weight\"\nactivity = ";
  const Subject s = read("body_mass_kg = 70\n" + good_ + load + "\"stairs_up\"\n");
  EXPECT_DOUBLE_EQ(s.joint.percent, 251.0);
  const std::string unknown = error_of("body_mass_kg = 70\n" + good_ + load + "\"flying\"\n");
  EXPECT_NE(unknown.find("there is no load of \"flying\""), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("walking"), std::string::npos) << unknown;
  const std::string both =
      error_of("body_mass_kg = 70\n" + good_ + load + "\"walking\"\npercent_body_weight = 200\n");
  EXPECT_NE(both.find("exclude each other"), std::string::npos) << both;
}
TEST_F(SubjectFile, WantsASide) {
  EXPECT_NE(error_of("side = \"port\"\n").find("must be \"left\" or \"right\""), std::string::npos);
}

}  // namespace coxa::pipeline
