#pragma once

#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace coxa {

/// Why an operation on somebody's data or request failed; `exit_code` maps it to the process's exit
/// code.
enum class ErrorCode {
  usage,           ///< the request itself is wrong (options, command line)
  bad_input,       ///< the data or an option value cannot be used
  bad_file,        ///< a file is missing, unreadable, broken, or cannot be written
  bad_mesh,        ///< a surface or volume mesh is not valid
  no_convergence,  ///< a solver did not reach its tolerance
  below_quality,   ///< a result misses the quality asked for
  cancelled        ///< interrupted by the user
};

/// 2 usage, 3 bad input, file or mesh, 4 no convergence, 5 below quality, 130 cancelled.
int exit_code(ErrorCode code);

/// The code's name as written in JSON output, for example "bad_input".
std::string_view name(ErrorCode code);

/// Failure caused by data or request; the text says what, where, the value, the limit and what to
/// do.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

/// Joins the parts as text, as with `operator<<`.
template <class... Parts>
std::string join_text(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// Throws Error(code) with the joined parts.
template <class... Parts>
[[noreturn]] void fail(ErrorCode code, const Parts&... parts) {
  throw Error(code, join_text(parts...));
}

/// Throws Error(bad_input) with the joined parts unless `condition` holds.
template <class... Parts>
void require(bool condition, const Parts&... parts) {
  if (!condition) fail(ErrorCode::bad_input, parts...);
}

/// Prints the expression and its place, then aborts: our own mistake, not the user's.
[[noreturn]] void assertion_failed(const char* expression, const char* file, int line);

}  // namespace coxa

#define COXA_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::coxa::assertion_failed(#condition, __FILE__, __LINE__))

#ifdef NDEBUG
#define COXA_DEBUG_ASSERT(condition) static_cast<void>(0)
#else
#define COXA_DEBUG_ASSERT(condition) COXA_ASSERT(condition)
#endif
