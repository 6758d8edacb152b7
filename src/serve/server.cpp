#include <coxa/serve/server.h>

#include <coxa/core/error.h>

#include <boost/asio/post.hpp>
#include <boost/asio/strand.hpp>

#include "sessions.h"

namespace coxa::serve {
namespace {

constexpr auto kCancelCheck = std::chrono::milliseconds(100);

Tcp::endpoint endpoint_of(const ServerOptions& options) {
  ErrorCode error;
  const auto address = asio::ip::make_address(options.address, error);
  require(!error, options.address, " is not an IP address to listen on");
  require(address.is_loopback() || !options.token.empty(), "listening on ", options.address,
          " opens the subject's folder to the network: that needs a token");
  return {address, options.port};
}

}  // namespace

Response text_response(int status, std::string type, std::string body) {
  return {status, std::move(type), std::make_shared<const std::string>(std::move(body)), ""};
}

struct Server::Impl {
  Hub hub;
  Tcp::acceptor acceptor;
  asio::steady_timer timer;

  Impl(Application& application, const ServerOptions& options)
      : hub{application, options}, acceptor(hub.network), timer(hub.network) {
    const Tcp::endpoint endpoint = endpoint_of(options);
    ErrorCode error;
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    require(!error, "cannot listen on ", options.address, " port ", options.port, ": ",
            error.message());
  }

  void accept() {
    acceptor.async_accept(hub.network, [this](ErrorCode error, Tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      // a socket that goes out of scope here is closed
      if (!error && hub.connections < hub.options.max_connections) {
        socket.set_option(Tcp::no_delay(true), error);
        std::make_shared<HttpSession>(hub, std::move(socket))->read();
      }
      accept();
    });
  }

  void watch(const Monitor& monitor) {
    timer.expires_after(kCancelCheck);
    timer.async_wait([this, &monitor](ErrorCode error) {
      if (error) return;
      if (!monitor.cancelled()) return watch(monitor);
      ErrorCode ignored;
      acceptor.close(ignored);
      for (HttpSession* session : hub.requests) session->close();
      for (const auto& [id, socket] : hub.sockets) {
        if (const auto session = socket.lock()) session->close();
      }
    });
  }
};

Server::Server(Application& application, const ServerOptions& options)
    : impl_(std::make_unique<Impl>(application, options)) {}
Server::~Server() = default;

std::uint16_t Server::port() const { return impl_->acceptor.local_endpoint().port(); }

void Server::run(const Monitor& monitor) {
  impl_->accept();
  impl_->watch(monitor);
  impl_->hub.network.run();
  impl_->hub.workers.join();
  // answers that the workers posted last still hold their connections
  impl_->hub.network.restart();
  impl_->hub.network.poll();
}

void Server::send(ClientId client, Message message) {
  asio::post(impl_->hub.network, [this, client, message = std::move(message)]() mutable {
    const auto it = impl_->hub.sockets.find(client);
    if (it == impl_->hub.sockets.end()) return;
    if (const auto session = it->second.lock()) session->send(std::move(message));
  });
}

void Server::send_to_all(Message message) {
  asio::post(impl_->hub.network, [this, message = std::move(message)] {
    for (const auto& [id, socket] : impl_->hub.sockets) {
      if (const auto session = socket.lock()) session->send(message);
    }
  });
}

}  // namespace coxa::serve
