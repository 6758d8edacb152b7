#include <coxa/core/error.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/movement_files.h>

#include "../../src/serve/found_surfaces.h"
#include "serve/viewing.h"

namespace coxa::serve {
namespace {
using Json = nlohmann::json;
using boost::beast::http::verb;

/// A subject's folder just begun: an image, and one surface.
class Viewing : public test::Viewing {
  void fill() override {
    io::write_bytes(web.path / "assets/main.js", "1");
    io::write_bytes(folder.path / "report/report.html", "<style></style>");
    io::write_volume(folder.path / "t1.nii.gz", test::tiny_volume(), io::VoxelType::int16);
    TriMesh mesh;
    mesh.points.resize(4, 3);
    mesh.points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    mesh.triangles.resize(4, 3);
    mesh.triangles << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
    io::write_surface(folder.path / "segment/femur.vtp", mesh);
  }
};

TEST_F(Viewing, ServesTheApplicationAndTheFolderAndNothingElse) {
  EXPECT_EQ(http->get("/").body(), "<!doctype html>");
  EXPECT_EQ(http->status("/assets/main.js"), 200);
  EXPECT_EQ(http->get("/files/report/report.html").body(), "<style></style>");
  io::write_bytes(folder.path.parent_path() / "coxa_outside.txt", "secret");
  for (const char* path :
       {"/files/../coxa_outside.txt", "/files/%2e%2e/coxa_outside.txt", "/../etc/passwd",
        "/files/report", "/files//etc/passwd", "/nothing", "/api/nothing"})
    EXPECT_EQ(http->status(path), 404) << path;
  EXPECT_EQ(http->status("/files/%zz"), 400);
  std::filesystem::remove(folder.path.parent_path() / "coxa_outside.txt");
}
TEST_F(Viewing, GivesReportsNoScript) {
  const auto report = http->get("/files/report/report.html");
  const std::string policy(report["Content-Security-Policy"]);
  EXPECT_NE(policy.find("sandbox"), std::string::npos);
  EXPECT_EQ(policy.find("script-src"), std::string::npos);
}
TEST_F(Viewing, SaysWhatTheFolderHolds) {
  const Json json = get("/api/case");
  EXPECT_EQ(json["surfaces"], Json::array({"femur"}));
  EXPECT_EQ(json["image"], "t1.nii.gz");
  EXPECT_EQ(json["live"], false);
  EXPECT_FALSE(json.contains("summary"));
}
TEST_F(Viewing, HoldsALabrumWhereTheFolderOrItsJointFileHasOne) {
  EXPECT_NE(http->status("/api/surface?name=acetabular_labrum"), 200);
  const auto femur = folder.path / "segment/femur.vtp", other = folder.path / "labrum.vtp";
  std::filesystem::copy(femur, other);
  for (const char* name : {"mesh/a.vtu", "mesh/f.vtu", "motion/x"})
    io::write_bytes(folder.path / name, "");
  io::write_bytes(folder.path / "joint/joint.toml",
                  "side = \"left\"\nacetabular_cartilage = \"../mesh/a.vtu\"\n"
                  "femoral_cartilage = \"../mesh/f.vtu\"\nmotion = \"../motion\"\n"
                  "acetabular_labrum = \"../labrum.vtp\"\n");
  EXPECT_EQ(get("/api/case")["surfaces"], Json::array({"femur", "acetabular_labrum"}));
  EXPECT_EQ(http->get("/api/surface?name=acetabular_labrum").body().substr(0, 4), "CXB1");
  std::filesystem::remove_all(folder.path / "joint");
  std::filesystem::rename(other, folder.path / "segment/acetabular_labrum.vtp");
  EXPECT_EQ(get("/api/case")["surfaces"], Json::array({"femur", "acetabular_labrum"}));
}
TEST_F(Viewing, HasFoundNothingBeforeASegmentationRuns) {
  EXPECT_EQ(http->status("/api/found?name=femur"), 404);
}
TEST(FoundSurfaces, KeepWhatWasFoundLastOfEachStructure) {
  FoundSurfaces found;
  SurfaceSet surfaces;
  surfaces["femur"].mesh = {Points::Zero(3, 3), (Triangles(1, 3) << 0, 1, 2).finished()};
  found.set(surfaces);
  const std::string first = found.bundle("femur").value();
  surfaces["femur"].mesh.points(0, 0) = 1.0;
  surfaces["hip_bone"] = surfaces["femur"];
  found.set(surfaces);
  EXPECT_NE(found.bundle("femur").value(), first);
  EXPECT_TRUE(found.bundle("hip_bone").has_value());
  found.clear();
  EXPECT_FALSE(found.bundle("femur").has_value());
}
TEST_F(Viewing, SendsSurfaceAndImageAsBundles) {
  EXPECT_EQ(http->get("/api/surface?name=femur").body().substr(0, 4), "CXB1");
  const std::string image = http->get("/api/image").body();
  std::uint32_t length = 0;
  std::memcpy(&length, image.data() + 4, 4);
  const Json meta = Json::parse(image.substr(8, length))["meta"];
  EXPECT_EQ(meta["size"], Json::array({4, 3, 2}));
  EXPECT_EQ(meta["low"], -5.0);
  EXPECT_EQ(meta["step"], 1.0);  // whole numbers stay what they are
  std::uint16_t last = 0;
  std::memcpy(&last, image.data() + 8 + length + 2 * 23, 2);
  EXPECT_EQ(last, 23);
}
TEST_F(Viewing, ExplainsWhatIsNotThere) {
  EXPECT_EQ(http->status("/api/surface?name=hip_bone"), 404);
  EXPECT_EQ(http->status("/api/surface?name=../femur"), 400);
  EXPECT_EQ(http->status("/api/frame?index=x"), 400);
  EXPECT_EQ(http->status("/api/frame?index=0"), 400);
  EXPECT_EQ(http->ask(verb::post, "/api/case").result_int(), 405u);
}
TEST_F(Viewing, KeepsLandmarksAndNoticesASecondEditor) {
  const Json before = get("/api/landmarks");
  EXPECT_EQ(before["version"], "");
  const Json wanted{{"version", ""},
                    {"landmarks", {{{"name", "asis_right"}, {"position_lps_mm", {1, 2, 3}}}}}};
  EXPECT_EQ(put("/api/landmarks", wanted).result_int(), 200u);
  const auto stored = io::read_landmarks(folder.path / "landmarks.mrk.json");
  EXPECT_EQ(stored.at("asis_right"), Vec3(1, 2, 3));
  EXPECT_EQ(put("/api/landmarks", wanted).result_int(), 409u);  // an old version
}
TEST_F(Viewing, RefusesLandmarksThatAreNone) {
  const auto status = [&](const Json& list) {
    return put("/api/landmarks", {{"version", ""}, {"landmarks", list}}).result_int();
  };
  EXPECT_EQ(status({{{"name", "../x"}, {"position_lps_mm", {1, 2, 3}}}}), 400u);
  EXPECT_EQ(status({{{"name", "a"}, {"position_lps_mm", {1, 2}}}}), 400u);
  EXPECT_EQ(status({{{"name", "a"}, {"position_lps_mm", {1, 2, 1e9}}}}), 400u);
  EXPECT_EQ(status("none"), 400u);
  EXPECT_EQ(http->ask(verb::put, "/api/landmarks", {}, "{").result_int(), 400u);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "landmarks.mrk.json"));
}
TEST_F(Viewing, KeepsPinsOfKnownStructures) {
  EXPECT_EQ(get("/api/pins")["landmarks"], Json::array());
  const auto wanted = [&](const std::string& name) {
    return Json{{"version", get("/api/pins")["version"]},
                {"landmarks", {{{"name", name}, {"position_lps_mm", {1, 2, 3}}}}}};
  };
  for (const char* name : {"femur", "femur1", "-1", "sacrum-1", "../femur-1"})
    EXPECT_EQ(put("/api/pins", wanted(name)).result_int(), 400u) << name;
  EXPECT_EQ(put("/api/pins", wanted("acetabular_cartilage-2")).result_int(), 200u);
  EXPECT_EQ(io::read_landmarks(folder.path / "pins.mrk.json").at("acetabular_cartilage-2"),
            Vec3(1, 2, 3));
  Json none = wanted("");
  EXPECT_EQ(put("/api/pins", {{"version", ""}, {"landmarks", Json::array()}}).result_int(), 409u);
  none["landmarks"] = Json::array();
  EXPECT_EQ(put("/api/pins", none).result_int(), 200u);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "pins.mrk.json"));
}
TEST_F(Viewing, HasBandsOfNormalGaitThatSurroundTheMovement) {
  const Json curves = get("/api/case")["normal_curves"];
  const auto gait =
      io::read_pattern(std::filesystem::path(COXA_SOURCE_DIR) / "data/movements/gait.toml");
  ASSERT_EQ(curves.size(), 3u);
  for (const Json& curve : curves) {
    EXPECT_EQ(curve["movement"], "gait");
    EXPECT_NE(curve["source"].get<std::string>().find("Schwartz"), std::string::npos);
    for (std::size_t k = 1; k + 1 < gait.poses.size(); ++k) {
      const motion::HipAngles& a = gait.poses[k].angles;
      const double mean = degrees(curve["angle"] == "flexion_deg"     ? a.flexion
                                  : curve["angle"] == "adduction_deg" ? a.adduction
                                                                      : a.internal_rotation);
      EXPECT_EQ(curve["percent"][k].get<double>(), 4.0 * static_cast<double>(k));
      EXPECT_NEAR(0.5 * (curve["low"][k].get<double>() + curve["high"][k].get<double>()), mean,
                  0.015);
    }
  }
}
TEST_F(Viewing, ShowsASecondResultOnlyWhereOneWasGiven) {
  EXPECT_EQ(http->status("/api/case?of=other"), 400);
  test::TempFolder second("coxa_second");
  ViewApplication both(folder.path, web.path, second.path);
  test::RunningServer server(both);
  EXPECT_EQ(Json::parse(server.get("/api/case").body())["other"], second.path.filename().string());
  const Json other = Json::parse(server.get("/api/case?of=other").body());
  EXPECT_EQ(other["surfaces"], Json::array());
  EXPECT_FALSE(other.contains("other"));
  EXPECT_EQ(server.status("/api/surface?name=femur"), 200);
  EXPECT_EQ(server.status("/api/surface?of=other&name=femur"), 404);
  // the second is looked at, not edited, and its files are not served
  EXPECT_EQ(server.status("/files/../" + second.path.filename().string() + "/x"), 404);
}
TEST_F(Viewing, SavesARecordedMovementInTheFormOfTheOthers) {
  const Json movement{{"name", "by_hand"},
                      {"time_s", {0.0, 1.0}},
                      {"flexion_deg", {0.0, 30.0}},
                      {"adduction_deg", {0.0, -5.0}},
                      {"internal_rotation_deg", {0.0, 10.0}}};
  ASSERT_EQ(put("/api/movement", movement).result_int(), 200u);
  const auto pattern = io::read_pattern(folder.path / "movements/by_hand.toml");
  EXPECT_NEAR(degrees(pattern.poses.at(1).angles.flexion), 30.0, 1e-9);
  Json broken = movement;
  broken["time_s"] = {0.0, 0.0};
  EXPECT_EQ(put("/api/movement", broken).result_int(), 400u);
  broken = movement;
  broken["name"] = "../up";
  EXPECT_EQ(put("/api/movement", broken).result_int(), 400u);
}
TEST_F(Viewing, AnswersMalformedMessagesWithAnError) {
  auto socket = http->socket();
  EXPECT_EQ(Json::parse(test::read_text(socket))["type"], "hello");
  for (const char* text :
       {"", "{", "[]", "{}", "{\"type\":1}", "{\"type\":\"nothing\"}", "{\"type\":\"pose\"}",
        "{\"type\":\"pose\",\"number\":1,\"flexion_deg\":1e9,\"adduction_deg\":0,"
        "\"internal_rotation_deg\":0}",
        "{\"type\":\"job_start\",\"job\":\"rm\"}", "\xff\xfe"}) {
    socket.binary(true);
    socket.write(boost::asio::buffer(std::string(text)));
    EXPECT_EQ(Json::parse(test::read_text(socket))["type"], "error") << text;
  }
}
TEST_F(Viewing, SaysWhyThereIsNoLiveExamination) {
  auto socket = http->socket();
  test::read_text(socket);
  socket.write(boost::asio::buffer(std::string(
      R"({"type":"pose","number":1,"flexion_deg":1,"adduction_deg":0,"internal_rotation_deg":0})")));
  const Json answer = Json::parse(test::read_text(socket));
  EXPECT_EQ(answer["type"], "live_error");
  EXPECT_EQ(answer["number"], 1);
}
TEST_F(Viewing, ReportsAJobThatFails) {
  auto socket = http->socket();
  test::read_text(socket);
  // an image of 24 voxels holds no hip
  socket.write(
      boost::asio::buffer(std::string(R"({"type":"job_start","job":"segment","side":"right"})")));
  Json answer;
  do answer = Json::parse(test::read_text(socket));
  while (answer.value("state", "") == "running");
  EXPECT_EQ(answer["state"], "failed") << answer;
  EXPECT_FALSE(answer["text"].get<std::string>().empty());
  EXPECT_EQ(get("/api/job")["state"], "failed");
  EXPECT_FALSE(std::filesystem::exists(folder.path / "segment.partial"));
}
TEST(ViewApplication, SaysThatTheWebApplicationIsNotBuilt) {
  test::TempFolder folder("coxa_bare");
  EXPECT_THROW(ViewApplication(folder.path, folder.path / "no_web"), Error);
}

}  // namespace
}  // namespace coxa::serve
