#pragma once

#include <coxa/io/surfaces.h>
#include <coxa/io/volumes.h>
#include <coxa/serve/view_application.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "serve/client.h"

namespace coxa::test {

/// 4 × 3 × 2 voxels of the values -5 to 18.
inline Volume tiny_volume() {
  Volume volume;
  volume.size = {4, 3, 2};
  volume.origin = {-1.0, -2.0, -3.0};
  for (int i = 0; i < 24; ++i) volume.values.push_back(static_cast<float>(i - 5));
  return volume;
}

/// The application over a folder, with a server and the usual requests.
class Viewing : public ::testing::Test {
 protected:
  using Json = nlohmann::json;
  TempFolder folder{"coxa_view"}, web{"coxa_web"};
  std::unique_ptr<serve::ViewApplication> application;
  std::unique_ptr<RunningServer> http;

  void SetUp() override {
    io::write_bytes(web.path / "index.html", "<!doctype html>");
    fill();
    application = std::make_unique<serve::ViewApplication>(folder.path, web.path);
    http = std::make_unique<RunningServer>(*application);
    application->connect(http->server);
  }
  void TearDown() override { http.reset(); }
  virtual void fill() {}

  Json get(const std::string& target) { return Json::parse(http->get(target).body()); }
  boost::beast::http::response<boost::beast::http::string_body> put_bytes(
      const std::string& target, const std::string& body, const Headers& headers = {}) {
    return http->ask(boost::beast::http::verb::put, target, headers, body);
  }
  boost::beast::http::response<boost::beast::http::string_body> put(const std::string& target,
                                                                    const Json& body) {
    return put_bytes(target, body.dump());
  }
};

}  // namespace coxa::test
