#include <boost/asio/dispatch.hpp>

#include "sessions.h"

namespace coxa::serve {

SocketSession::SocketSession(Hub& hub, Tcp::socket socket)
    : hub_(hub), id_(hub.next_client++), stream_(std::move(socket)) {
  ++hub_.connections;
  stream_.read_message_max(hub_.options.max_message);
  auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
  timeout.idle_timeout = std::chrono::seconds(2 * hub_.options.timeout_seconds);
  timeout.keep_alive_pings = true;
  stream_.set_option(timeout);
}

SocketSession::~SocketSession() {
  --hub_.connections;
  hub_.sockets.erase(id_);
  if (open_) hub_.application.closed(id_);
}

void SocketSession::accept(const HttpRequest& request) {
  hub_.sockets[id_] = shared_from_this();
  stream_.async_accept(request, [self = shared_from_this()](ErrorCode error) {
    if (error) return;
    self->open_ = true;
    self->hub_.application.opened(self->id_);
    self->read();
  });
}

void SocketSession::read() {
  stream_.async_read(buffer_, [self = shared_from_this()](ErrorCode error, std::size_t) {
    // an oversized message ends the connection: the browser opens a new one
    if (error) return;
    self->hub_.application.received(self->id_, beast::buffers_to_string(self->buffer_.data()));
    self->buffer_.consume(self->buffer_.size());
    self->read();
  });
}

void SocketSession::send(Message message) {
  if (!stream_.is_open()) return;
  queued_bytes_ += message.bytes->size();
  if (queued_bytes_ > hub_.options.max_queue) return close();
  queue_.push_back(std::move(message));
  if (queue_.size() == 1) write_next();
}

void SocketSession::write_next() {
  const Message& message = queue_.front();
  stream_.binary(message.kind == Message::Kind::binary);
  stream_.async_write(asio::buffer(*message.bytes),
                      [self = shared_from_this()](ErrorCode error, std::size_t) {
                        if (error) return;
                        self->queued_bytes_ -= self->queue_.front().bytes->size();
                        self->queue_.pop_front();
                        if (!self->queue_.empty()) self->write_next();
                      });
}

void SocketSession::close() {
  ErrorCode ignored;
  beast::get_lowest_layer(stream_).socket().close(ignored);
}

}  // namespace coxa::serve
