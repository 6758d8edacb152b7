#include <coxa/serve/server.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include "serve/client.h"

namespace coxa::serve {
namespace {

/// Answers with what it was asked, and sends back what it is told.
struct Echo : Application {
  Server* server = nullptr;
  std::atomic<int> requests{0}, open{0};
  Response respond(const Request& request) override {
    ++requests;
    return text_response(200, "text/plain", request.method + " " + request.path + request.body);
  }
  void opened(ClientId) override { ++open; }
  void closed(ClientId) override { --open; }
  void received(ClientId client, std::string text) override {
    server->send(client,
                 {Message::Kind::text, std::make_shared<const std::string>(std::move(text))});
  }
};

struct Running {
  Echo echo;
  test::RunningServer http;
  explicit Running(const ServerOptions& options = {}) : http(echo, options) {
    echo.server = &http.server;
  }
};

TEST(Server, AnswersRequestsAndMessages) {
  Running run;
  EXPECT_EQ(run.http.get("/a%20b?c=d").body(), "GET /a b");
  auto socket = run.http.socket();
  socket.write(boost::asio::buffer(std::string("hello")));
  EXPECT_EQ(test::read_text(socket), "hello");
}
TEST(Server, SendsASecurityPolicyWithEveryAnswer) {
  Running run;
  const auto answer = run.http.get("/");
  const std::string policy(answer["Content-Security-Policy"]);
  EXPECT_NE(policy.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(policy.find("script-src 'self';"), std::string::npos);
  EXPECT_EQ(policy.find("unsafe"), std::string::npos);
  EXPECT_EQ(answer["X-Content-Type-Options"], "nosniff");
}
TEST(Server, RefusesForeignHostsAndOriginsBeforeTheApplicationSeesThem) {
  Running run;
  EXPECT_EQ(run.http.status("/", {{"Host", "evil.example"}}), 403);
  EXPECT_EQ(run.http.status("/", {{"Origin", "http://evil.example"}}), 403);
  EXPECT_THROW(run.http.socket({{"Origin", "http://evil.example"}}), boost::system::system_error);
  EXPECT_EQ(run.echo.requests, 0);
}
TEST(Server, WantsATokenWhereOneIsSet) {
  ServerOptions options;
  options.token = "secret";
  Running run(options);
  EXPECT_EQ(run.http.status("/"), 403);
  const auto first = run.http.get("/?token=secret");
  EXPECT_EQ(first.result_int(), 200u);
  const std::string cookie(first[boost::beast::http::field::set_cookie]);
  EXPECT_NE(cookie.find("HttpOnly"), std::string::npos);
  EXPECT_EQ(run.http.status("/", {{"Cookie", cookie.substr(0, cookie.find(';'))}}), 200);
  EXPECT_THROW(run.http.socket(), boost::system::system_error);
  EXPECT_NO_THROW(run.http.socket({{"Cookie", "coxa_token=secret"}}));
}
TEST(Server, DoesNotListenToTheNetworkWithoutAToken) {
  Echo echo;
  EXPECT_THROW(Server(echo, {.address = "0.0.0.0"}), Error);
  EXPECT_THROW(Server(echo, {.address = "not an address"}), Error);
}
TEST(Server, SaysThatThePortIsTaken) {
  Running run;
  Echo echo;
  try {
    Server second(echo, {.port = run.http.server.port()});
    FAIL() << "two servers on one port";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("port"), std::string::npos) << error.what();
  }
}
TEST(Server, SurvivesWhatIsNotHttp) {
  Running run;
  for (const std::string& text :
       {std::string("\x16\x03\x01 hello"), std::string("GET\r\n\r\n"), std::string(70000, 'a'),
        std::string("POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n")}) {
    auto socket = run.http.connected();
    boost::system::error_code ignored;
    boost::asio::write(socket, boost::asio::buffer(text), ignored);
  }
  EXPECT_EQ(run.http.status("/"), 200);
}
TEST(Server, RefusesABodyOverTheLimit) {
  ServerOptions options;
  options.max_body = 1000;
  Running run(options);
  const auto answer = run.http.ask(boost::beast::http::verb::put, "/", {}, std::string(1001, 'x'));
  EXPECT_EQ(answer.result_int(), 413u);
  EXPECT_EQ(
      run.http.ask(boost::beast::http::verb::put, "/", {}, std::string(1000, 'x')).result_int(),
      200u);
}
TEST(Server, EndsAConnectionWhoseMessageIsTooLarge) {
  ServerOptions options;
  options.max_message = 1000;
  Running run(options);
  auto socket = run.http.socket();
  socket.write(boost::asio::buffer(std::string(1001, 'x')));
  EXPECT_THROW(test::read_text(socket), boost::system::system_error);
  EXPECT_EQ(run.http.status("/"), 200);
}
TEST(Server, ClosesConnectionsAboveTheLimit) {
  ServerOptions options;
  options.max_connections = 3;
  Running run(options);
  {
    auto a = run.http.socket(), b = run.http.socket(), c = run.http.socket();
    EXPECT_THROW(run.http.get("/"), std::runtime_error);
  }
  // the places are free again once their owners have gone
  for (int attempt = 0; attempt < 100 && run.echo.open > 0; ++attempt)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(run.http.status("/"), 200);
}
TEST(Server, SurvivesAThousandQuickReconnects) {
  Running run;
  int served = 0;
  for (int i = 0; i < 1000; ++i) {
    try {
      auto socket = run.http.socket();
      ++served;
      if (i % 3 == 0) socket.write(boost::asio::buffer(std::string("x")));
    } catch (const boost::system::system_error&) {  // above the limit for a moment: allowed
    }
  }
  for (int attempt = 0; attempt < 300 && run.echo.open > 0; ++attempt)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(run.echo.open, 0);
  EXPECT_GT(served, 500);
  EXPECT_EQ(run.http.status("/"), 200);
}
TEST(Server, DropsARequestThatDoesNotArriveInTime) {
  ServerOptions options;
  options.timeout_seconds = 1;
  Running run(options);
  auto socket = run.http.connected();
  boost::asio::write(socket, boost::asio::buffer(std::string("GET / HTTP/1.1\r\n")));
  char byte = 0;
  boost::system::error_code error;
  boost::asio::read(socket, boost::asio::buffer(&byte, 1), error);  // returns when it is closed
  EXPECT_TRUE(error);
}

}  // namespace
}  // namespace coxa::serve
