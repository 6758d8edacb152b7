#include <coxa/serve/guard.h>

#include <boost/asio/post.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include <limits>

#include "sessions.h"

namespace coxa::serve {
namespace {

// scripts, styles and connections of this server alone; pictures also from the page itself
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";
constexpr std::uint32_t kMaxHeader = 16u << 10;
constexpr int kLargeBodyPatience = 10;  // times the usual timeout

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

std::string_view path_part(std::string_view target) { return target.substr(0, target.find('?')); }
std::string_view query_part(std::string_view target) {
  const std::size_t mark = target.find('?');
  return mark == std::string_view::npos ? std::string_view{} : target.substr(mark + 1);
}

}  // namespace

/// An answer on its way: the body is shared, so it is sent from where it lies.
struct HttpSession::Reply {
  http::response<http::buffer_body> head;
  std::shared_ptr<const std::string> body;
  std::optional<http::response_serializer<http::buffer_body>> serializer;
};

HttpSession::HttpSession(Hub& hub, Tcp::socket socket) : hub_(hub), stream_(std::move(socket)) {
  ++hub_.connections;
  hub_.requests.insert(this);
}

HttpSession::~HttpSession() {
  --hub_.connections;
  hub_.requests.erase(this);
}

void HttpSession::close() {
  ErrorCode ignored;
  stream_.socket().close(ignored);
}

void HttpSession::read() {
  parser_.emplace();
  parser_->header_limit(kMaxHeader);
  // until it is known who asks for what; Boost 1.74 takes `none` for no body at all
  parser_->body_limit(std::numeric_limits<std::uint64_t>::max());
  stream_.expires_after(std::chrono::seconds(hub_.options.timeout_seconds));
  http::async_read_header(
      stream_, buffer_, *parser_,
      [self = shared_from_this()](ErrorCode error, std::size_t) { self->on_header(error); });
}

bool HttpSession::broken(ErrorCode error) {
  if (!error) return false;
  if (error == http::error::body_limit || error == http::error::header_limit) {
    refuse(413, "this request is too large");
  } else if (error != http::error::end_of_stream &&
             error.category() == http::make_error_code(http::error::bad_method).category()) {
    refuse(400, "this is not an HTTP request");
  }
  return true;
}

void HttpSession::refuse(int status, const std::string& why) {
  request_ = {};
  request_.keep_alive(false);
  answer(text_response(status, "text/plain", why + "\n"));
}

void HttpSession::on_header(ErrorCode error) {
  if (broken(error)) return;
  const HttpRequest& head = parser_->get();
  const std::string_view target = view_of(head.target());
  const Claims claims{view_of(head[http::field::host]), view_of(head[http::field::origin]),
                      view_of(head[http::field::cookie]), query_part(target)};
  const std::string why = refusal(claims, hub_.options.token);
  if (!why.empty()) return refuse(403, why);

  std::size_t limit = hub_.options.max_body;
  int seconds = hub_.options.timeout_seconds;
  if (head.method() == http::verb::put) {
    const std::size_t own = hub_.application.body_limit(std::string(path_part(target)));
    if (own > limit) limit = own, seconds *= kLargeBodyPatience;
  }
  const auto length = parser_->content_length();
  if (length && *length > limit) return refuse(413, "this request is too large");
  parser_->body_limit(limit);
  stream_.expires_after(std::chrono::seconds(seconds));
  http::async_read(
      stream_, buffer_, *parser_,
      [self = shared_from_this()](ErrorCode error_, std::size_t) { self->on_read(error_); });
}

void HttpSession::on_read(ErrorCode error) {
  if (broken(error)) return;
  request_ = parser_->release();
  const std::string_view target = view_of(request_.target());
  if (websocket::is_upgrade(request_)) {
    if (path_part(target) != "/ws")
      return answer(text_response(404, "text/plain", "there is no such socket\n"));
    stream_.expires_never();
    std::make_shared<SocketSession>(hub_, stream_.release_socket())->accept(request_);
    return;
  }
  const auto path = percent_decoded(path_part(target));
  if (!path || path->empty() || path->front() != '/')
    return answer(text_response(400, "text/plain", "this is no path\n"));
  Request request{std::string(request_.method_string()), *path, std::string(query_part(target)),
                  std::move(request_.body())};
  stream_.expires_never();  // the answer may take long
  asio::post(hub_.workers, [self = shared_from_this(), request = std::move(request)]() mutable {
    Response response = self->hub_.application.respond(request);
    asio::post(self->hub_.network, [self, response = std::move(response)]() mutable {
      self->answer(std::move(response));
    });
  });
}

std::string HttpSession::cookie_header() const {
  // the token of the first visit's address goes into a cookie that scripts and other sites cannot
  // read
  const std::string given = query_value(query_part(view_of(request_.target())), "token");
  if (hub_.options.token.empty() || given != hub_.options.token) return "";
  return "coxa_token=" + given + "; Path=/; HttpOnly; SameSite=Strict";
}

void HttpSession::answer(Response response) {
  auto reply = std::make_shared<Reply>();
  auto& head = reply->head;
  head.result(static_cast<unsigned>(response.status));
  head.version(11);
  head.keep_alive(request_.keep_alive());
  head.set(http::field::content_type, response.type);
  head.set("Content-Security-Policy",
           response.policy.empty() ? std::string(kPolicy) : response.policy);
  head.set("X-Content-Type-Options", "nosniff");
  head.set("Referrer-Policy", "no-referrer");
  head.set("Cross-Origin-Resource-Policy", "same-origin");
  head.set(http::field::cache_control, "no-store");
  const std::string cookie = cookie_header();
  if (!cookie.empty()) head.set(http::field::set_cookie, cookie);
  reply->body = std::move(response.body);
  head.content_length(reply->body->size());
  if (request_.method() != http::verb::head) {
    head.body().data = const_cast<char*>(reply->body->data());  // Beast only reads it
    head.body().size = reply->body->size();
  }
  head.body().more = false;
  reply->serializer.emplace(head);
  stream_.expires_after(std::chrono::seconds(hub_.options.timeout_seconds));
  http::async_write(stream_, *reply->serializer,
                    [self = shared_from_this(), reply](ErrorCode error, std::size_t) {
                      if (error) return;
                      if (reply->head.keep_alive()) return self->read();
                      ErrorCode ignored;
                      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
                    });
}

}  // namespace coxa::serve
