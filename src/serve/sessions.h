#pragma once

#include <coxa/serve/server.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <map>
#include <optional>
#include <set>

namespace coxa::serve {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using ErrorCode = beast::error_code;
using HttpRequest = http::request<http::string_body>;

class HttpSession;
class SocketSession;

/// What all connections share. Everything here is touched by the network thread alone.
struct Hub {
  Application& application;
  ServerOptions options;
  int connections = 0;
  ClientId next_client = 1;
  std::map<ClientId, std::weak_ptr<SocketSession>> sockets{};
  std::set<HttpSession*> requests{};
  // last, so that the sessions their handlers hold go before what those sessions refer to
  asio::io_context network{1};
  asio::thread_pool workers{1};  ///< where the application answers
};

/// One HTTP connection, until it closes or becomes a WebSocket.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(Hub& hub, Tcp::socket socket);
  ~HttpSession();
  void read();
  void close();

 private:
  struct Reply;
  void on_header(ErrorCode error);
  void on_read(ErrorCode error);
  bool broken(ErrorCode error);
  /// Answers without the body having been read: the connection ends with it.
  void refuse(int status, const std::string& why);
  void answer(Response response);
  std::string cookie_header() const;

  Hub& hub_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  HttpRequest request_;
};

/// One WebSocket connection.
class SocketSession : public std::enable_shared_from_this<SocketSession> {
 public:
  SocketSession(Hub& hub, Tcp::socket socket);
  ~SocketSession();
  void accept(const HttpRequest& request);
  void send(Message message);
  void close();

 private:
  void read();
  void write_next();

  Hub& hub_;
  ClientId id_;
  bool open_ = false;
  websocket::stream<beast::tcp_stream> stream_;
  beast::flat_buffer buffer_;
  std::deque<Message> queue_;
  std::size_t queued_bytes_ = 0;
};

}  // namespace coxa::serve
