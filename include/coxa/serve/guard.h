#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace coxa::serve {

/// What of a request decides whether it is let in.
struct Claims {
  std::string_view host;    ///< header Host
  std::string_view origin;  ///< header Origin; empty where there is none
  std::string_view cookie;  ///< header Cookie
  std::string_view query;   ///< after the question mark
};

/// Why a request is refused; empty when it is let in.
///
/// Without a token (loopback only) the host must be this machine's own name, so that no foreign
/// page reaches the server by a name that resolves here. With one the token must be in the cookie
/// `coxa_token` or in the query `token=`. An origin, where given, must be the host itself.
std::string refusal(const Claims& claims, std::string_view token);

/// Value of `key` in a query `a=b&c=d`, percent signs decoded; empty where it is missing.
std::string query_value(std::string_view query, std::string_view key);

/// Percent-decoded text; nullopt for a broken escape or a zero byte.
std::optional<std::string> percent_decoded(std::string_view text);

/// The regular file that a decoded URL path names inside `root`, links resolved; nullopt where
/// there is none, it lies outside, or it is no regular file.
std::optional<std::filesystem::path> file_inside(const std::filesystem::path& root,
                                                 std::string_view url_path);

/// 32 hexadecimal digits of the system's own randomness.
std::string make_token();

}  // namespace coxa::serve
