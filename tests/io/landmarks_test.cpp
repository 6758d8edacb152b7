#include <coxa/io/landmarks.h>

#include <coxa/io/files.h>

#include "io/test_files.h"

namespace coxa::io {
namespace {

const std::map<std::string, Vec3> kTwo = {{"asis_right", Vec3(-120.1, -30.25, 1.0 / 3.0)},
                                          {"femoral_head_centre", Vec3(-87.1, 22.7, -740.8)}};

TEST(Landmarks, ComeBackExactly) {
  const TestFolder folder;
  for (const char* name : {"a.mrk.json", "a.csv"}) {
    write_landmarks(folder / name, kTwo);
    EXPECT_EQ(read_landmarks(folder / name), kTwo) << name;
  }
}
TEST(Landmarks, RasListIsTurnedToLpsAndUnplacedPointsArePassedOver) {
  const TestFolder folder;
  write_bytes(folder / "a.mrk.json", R"({"markups": [{"coordinateSystem": "RAS", "controlPoints": [
      {"label": "a", "position": [1, 2, 3]},
      {"label": "b", "position": [0, 0, 0], "positionStatus": "undefined"}]}]})");
  const std::map<std::string, Vec3> expected = {{"a", Vec3(-1, -2, 3)}};
  EXPECT_EQ(read_landmarks(folder / "a.mrk.json"), expected);
}
TEST(Landmarks, CsvColumnsMayComeInAnyOrderAndBeQuoted) {
  const TestFolder folder;
  write_bytes(folder / "a.csv",
              "note,x,y,z,kind,name\r\n\"a, \"\"b\"\"\",1,2,3,point,p\r\n-,0,0,1,axis,q\r\n");
  const std::map<std::string, Vec3> expected = {{"p", Vec3(1, 2, 3)}};
  EXPECT_EQ(read_landmarks(folder / "a.csv"), expected);
}
TEST(Landmarks, BadFilesAreNamedWithTheReason) {
  const TestFolder folder;
  const auto text_of = [&](ErrorCode code, const char* name, const char* content) {
    write_bytes(folder / name, content);
    return error_text(code, [&] { read_landmarks(folder / name); });
  };
  EXPECT_TRUE(contains(text_of(ErrorCode::bad_file, "a.mrk.json", "{\"markups\": ["),
                       "not a markups file"));
  EXPECT_TRUE(contains(text_of(ErrorCode::bad_file, "b.csv", "name,x,y\n"), "name, x, y, z"));
  EXPECT_TRUE(contains(text_of(ErrorCode::bad_file, "c.csv", "name,x,y,z\na,1,2,three\n"),
                       "c.csv:2: 'three'"));
  EXPECT_TRUE(
      contains(text_of(ErrorCode::bad_input, "d.csv", "name,x,y,z\na,1,2,3\na,1,2,3\n"), "twice"));
  EXPECT_TRUE(contains(text_of(ErrorCode::bad_input, "e.csv", "name,x,y,z\n"), "no landmark"));
  EXPECT_TRUE(contains(text_of(ErrorCode::bad_input, "f.txt", ""), ".mrk.json"));
  EXPECT_TRUE(
      contains(text_of(ErrorCode::bad_input, "g.mrk.json",
                       R"({"markups": [{"coordinateSystem": "XYZ", "controlPoints": []}]})"),
               "XYZ"));
}
TEST(Landmarks, LandmarksOfTheExampleSurfacesAreRead) {
  const std::filesystem::path path = COXA_SHARED_DIR "/data/libhip/m1/left/landmarks.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs " << path;
  const auto landmarks = read_landmarks(path);
  EXPECT_LT((landmarks.at("femoral_head_center") - Vec3(86.221, 19.875, -579.056)).norm(), 1e-9);
  EXPECT_FALSE(landmarks.contains("femoral_neck_axis"));
}

}  // namespace
}  // namespace coxa::io
