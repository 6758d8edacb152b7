#pragma once

#include <coxa/core/monitor.h>

#include <cstdint>
#include <memory>
#include <string>

namespace coxa::serve {

struct Request {
  std::string method;  ///< GET, PUT, POST
  std::string path;    ///< decoded, begins with /
  std::string query;   ///< as it came
  std::string body;
};

struct Response {
  int status = 200;
  std::string type = "application/json";
  std::shared_ptr<const std::string> body;  ///< shared with caches; never null when sent
  std::string policy;  ///< content security policy of this answer; empty: the application's own
};

Response text_response(int status, std::string type, std::string body);

using ClientId = std::uint64_t;  ///< one WebSocket connection

struct Message {
  enum class Kind { text, binary } kind = Kind::text;
  std::shared_ptr<const std::string> bytes;
};

/// What the server serves.
class Application {
 public:
  virtual ~Application() = default;
  /// Answers one request; may take long. Called on a thread of its own, one request at a time.
  virtual Response respond(const Request& request) = 0;
  /// Bytes that the body of a PUT to `path` may have where that is more than the server's usual
  /// limit; 0: the usual one. Called on the network thread, for requests that are let in.
  virtual std::size_t body_limit(const std::string& path) const {
    (void)path;
    return 0;
  }
  /// The three at the end are called on the network thread and must return at once.
  virtual void opened(ClientId client) = 0;
  virtual void closed(ClientId client) = 0;
  virtual void received(ClientId client, std::string text) = 0;
};

struct ServerOptions {
  std::string address = "127.0.0.1";    ///< where to listen; another needs a token
  std::uint16_t port = 0;               ///< 0: any free one
  std::string token = {};               ///< empty: none asked for, loopback only
  std::size_t max_body = 4u << 20;      ///< bytes of a request
  std::size_t max_message = 64u << 10;  ///< bytes of a WebSocket message from the browser
  std::size_t max_queue = 64u << 20;  ///< bytes waiting for one slow browser, which is then dropped
  int max_connections = 128;          ///< more are closed at once
  /// A request whose head, or whose body within the usual limit, takes longer to arrive is dropped;
  /// a larger body has ten times as long.
  int timeout_seconds = 30;
};

/// HTTP and WebSocket server of one application.
///
/// Requests that are not let in (see guard.h) get 403 before the application sees them. Every
/// answer carries a content security policy that allows this server alone.
class Server {
 public:
  /// Listens from here on.
  /// @throws Error bad_input if the address is not this machine's, not an address, the port is
  ///         taken, or another address than loopback has no token
  /// @note keeps a reference to the application, which must outlive it
  Server(Application& application, const ServerOptions& options);
  ~Server();

  std::uint16_t port() const;
  /// Serves until the monitor's flag is set. @returns when all connections are closed
  void run(const Monitor& monitor);
  /// From any thread; a client that has gone is no error.
  void send(ClientId client, Message message);
  void send_to_all(Message message);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coxa::serve
