#pragma once

#include <coxa/io/files.h>
#include <coxa/serve/server.h>

#include <atomic>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace coxa::test {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using Tcp = asio::ip::tcp;
using Headers = std::vector<std::pair<std::string, std::string>>;

/// A folder that is gone with the object.
struct TempFolder {
  std::filesystem::path path;
  explicit TempFolder(const std::string& name)
      : path(std::filesystem::temp_directory_path() /
             (name + "_" + std::to_string(static_cast<long>(::getpid())))) {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~TempFolder() { std::filesystem::remove_all(path); }
};

/// A server that runs beside the test.
class RunningServer {
 public:
  RunningServer(serve::Application& application, const serve::ServerOptions& options = {})
      : server(application, options), thread_([this] {
          Monitor monitor;
          monitor.cancel_flag = &stop_;
          server.run(monitor);
        }) {}
  ~RunningServer() {
    stop_ = true;
    thread_.join();
  }
  serve::Server server;

  Tcp::socket connected() {
    Tcp::socket socket(context_);
    socket.connect({asio::ip::address_v4::loopback(), server.port()});
    return socket;
  }
  std::string host() const { return "127.0.0.1:" + std::to_string(server.port()); }

  http::response<http::string_body> ask(http::verb method, const std::string& target,
                                        const Headers& headers = {}, const std::string& body = "") {
    http::request<http::string_body> request{method, target, 11, body};
    request.set(http::field::host, host());
    for (const auto& [key, value] : headers) request.set(key, value);
    request.prepare_payload();
    Tcp::socket socket = connected();
    beast::error_code error;
    http::write(socket, request, error);
    beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    parser.body_limit(std::uint64_t{1} << 30);
    if (!error) http::read(socket, buffer, parser, error);
    if (error) throw std::runtime_error(error.message());
    return parser.release();
  }
  http::response<http::string_body> get(const std::string& target, const Headers& headers = {}) {
    return ask(http::verb::get, target, headers);
  }
  int status(const std::string& target, const Headers& headers = {}) {
    return static_cast<int>(get(target, headers).result_int());
  }

  /// A WebSocket; `headers` are added to its request.
  beast::websocket::stream<Tcp::socket> socket(const Headers& headers = {},
                                               const std::string& target = "/ws") {
    beast::websocket::stream<Tcp::socket> stream(connected());
    stream.set_option(beast::websocket::stream_base::decorator(
        [headers](beast::websocket::request_type& request) {
          for (const auto& [key, value] : headers) request.set(key, value);
        }));
    stream.handshake(host(), target);
    return stream;
  }

 private:
  std::atomic<bool> stop_{false};
  asio::io_context context_;
  std::thread thread_;
};

inline std::string read_text(beast::websocket::stream<Tcp::socket>& stream) {
  beast::flat_buffer buffer;
  stream.read(buffer);
  return beast::buffers_to_string(buffer.data());
}

}  // namespace coxa::test
