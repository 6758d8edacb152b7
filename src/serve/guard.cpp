#include <coxa/serve/guard.h>

#include <algorithm>
#include <random>

namespace coxa::serve {
namespace fs = std::filesystem;
namespace {

int hex_value(char c) {
  if ('0' <= c && c <= '9') return c - '0';
  if ('a' <= c && c <= 'f') return c - 'a' + 10;
  if ('A' <= c && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Host without its port: "[::1]:80" becomes "[::1]".
std::string_view name_of(std::string_view host) {
  if (!host.empty() && host.front() == '[') return host.substr(0, host.find(']') + 1);
  return host.substr(0, host.find(':'));
}

bool is_own_name(std::string_view host) {
  const std::string_view name = name_of(host);
  return name == "localhost" || name == "127.0.0.1" || name == "[::1]";
}

std::string_view cookie_value(std::string_view cookie, std::string_view key) {
  while (!cookie.empty()) {
    const std::size_t end = cookie.find(';');
    std::string_view pair = cookie.substr(0, end);
    while (!pair.empty() && pair.front() == ' ') pair.remove_prefix(1);
    if (pair.size() > key.size() && pair.starts_with(key) && pair[key.size()] == '=')
      return pair.substr(key.size() + 1);
    if (end == std::string_view::npos) break;
    cookie.remove_prefix(end + 1);
  }
  return {};
}

/// Compares in a time that does not tell how many characters agree.
bool same(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

}  // namespace

std::string refusal(const Claims& claims, std::string_view token) {
  if (!claims.origin.empty() && claims.origin != "http://" + std::string(claims.host))
    return "this request comes from another page";
  if (token.empty())
    return is_own_name(claims.host) ? "" : "the host must be localhost or 127.0.0.1";
  if (same(cookie_value(claims.cookie, "coxa_token"), token)) return "";
  return same(query_value(claims.query, "token"), token)
             ? ""
             : "open the address that coxa view printed: it carries the token";
}

std::string query_value(std::string_view query, std::string_view key) {
  while (!query.empty()) {
    const std::size_t end = query.find('&');
    const std::string_view pair = query.substr(0, end);
    const std::size_t sign = pair.find('=');
    if (sign != std::string_view::npos && pair.substr(0, sign) == key)
      return percent_decoded(pair.substr(sign + 1)).value_or("");
    if (end == std::string_view::npos) break;
    query.remove_prefix(end + 1);
  }
  return "";
}

std::optional<std::string> percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      if (i + 2 >= text.size()) return std::nullopt;
      const int high = hex_value(text[i + 1]), low = hex_value(text[i + 2]);
      if (high < 0 || low < 0) return std::nullopt;
      c = static_cast<char>(16 * high + low);
      i += 2;
    }
    if (c == '\0') return std::nullopt;
    out += c;
  }
  return out;
}

std::optional<fs::path> file_inside(const fs::path& root, std::string_view url_path) {
  while (!url_path.empty() && url_path.front() == '/') url_path.remove_prefix(1);
  std::error_code error;
  const fs::path base = fs::canonical(root, error);
  if (error) return std::nullopt;
  const fs::path wanted = fs::canonical(base / fs::path(url_path), error);
  if (error || !fs::is_regular_file(wanted, error)) return std::nullopt;
  // canonical paths have neither .. nor links left: what begins with the root lies inside it
  const auto [end, rest] = std::mismatch(base.begin(), base.end(), wanted.begin(), wanted.end());
  if (end != base.end()) return std::nullopt;
  return wanted;
}

std::string make_token() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::random_device device;
  std::string token;
  for (int i = 0; i < 32; ++i) token += kDigits[device() % 16];
  return token;
}

}  // namespace coxa::serve
