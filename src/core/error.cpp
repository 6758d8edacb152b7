#include <coxa/core/error.h>

#include <cstdio>
#include <cstdlib>

namespace coxa {

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage:
      return 2;
    case ErrorCode::bad_input:
    case ErrorCode::bad_file:
    case ErrorCode::bad_mesh:
      return 3;
    case ErrorCode::no_convergence:
      return 4;
    case ErrorCode::below_quality:
      return 5;
    case ErrorCode::cancelled:
      return 130;
  }
  return 1;
}

std::string_view name(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage:
      return "usage";
    case ErrorCode::bad_input:
      return "bad_input";
    case ErrorCode::bad_file:
      return "bad_file";
    case ErrorCode::bad_mesh:
      return "bad_mesh";
    case ErrorCode::no_convergence:
      return "no_convergence";
    case ErrorCode::below_quality:
      return "below_quality";
    case ErrorCode::cancelled:
      return "cancelled";
  }
  return "unknown";
}

void assertion_failed(const char* expression, const char* file, int line) {
  std::fprintf(stderr, "coxa: internal error: %s is false at %s:%d\n", expression, file, line);
  std::abort();
}

}  // namespace coxa
