#include <coxa/serve/view_application.h>

#include <coxa/core/error.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/movement_files.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/volumes.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "serve/client.h"

namespace coxa::serve {
namespace {
using Json = nlohmann::json;
using boost::beast::http::verb;

/// A subject's folder just begun: an image, and one surface.
class Viewing : public ::testing::Test {
 protected:
  test::TempFolder folder{"coxa_view"}, web{"coxa_web"};
  std::unique_ptr<ViewApplication> application;
  std::unique_ptr<test::RunningServer> http;

  void SetUp() override {
    io::write_bytes(web.path / "index.html", "<!doctype html>");
    io::write_bytes(web.path / "assets/main.js", "1");
    io::write_bytes(folder.path / "report/report.html", "<style></style>");
    Volume volume;
    volume.size = {4, 3, 2};
    volume.origin = {-1.0, -2.0, -3.0};
    for (int i = 0; i < 24; ++i) volume.values.push_back(static_cast<float>(i - 5));
    io::write_volume(folder.path / "t1.nii.gz", volume, io::VoxelType::int16);
    TriMesh mesh;
    mesh.points.resize(4, 3);
    mesh.points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    mesh.triangles.resize(4, 3);
    mesh.triangles << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
    io::write_surface(folder.path / "segment/femur.vtp", mesh);
    application = std::make_unique<ViewApplication>(folder.path, web.path);
    http = std::make_unique<test::RunningServer>(*application);
    application->connect(http->server);
  }
  void TearDown() override { http.reset(); }

  Json get(const std::string& target) { return Json::parse(http->get(target).body()); }
  boost::beast::http::response<boost::beast::http::string_body> put(const std::string& target,
                                                                    const Json& body) {
    return http->ask(verb::put, target, {}, body.dump());
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
