#pragma once

#include <chrono>
#include <set>
#include <string>
#include <string_view>

namespace coxa::app {

enum class ProgressStyle {
  terminal,  ///< one line, written over
  lines,     ///< a line for every tenth
  log,       ///< a line for every hundredth and every step, with the time since the start
  json,      ///< JSON lines on standard output
  silent
};

/// One line with stage, share and time left on a terminal; plain lines when piped; a log with -v;
/// JSON lines with --json.
class ProgressPrinter {
 public:
  explicit ProgressPrinter(ProgressStyle style) : style_(style) {}
  void update(std::string_view stage, double share);
  /// Prints a warning, each text once.
  void warn(std::string_view text);
  /// Ends a terminal line in progress, so that what follows starts on its own line.
  void finish_line();

 private:
  double seconds_left(double share) const;
  bool worth_printing(std::string_view stage, double share) const;

  ProgressStyle style_;
  std::string stage_;
  double first_share_ = 0.0, printed_share_ = -1.0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), stage_start_,
                                        printed_at_;
  bool line_open_ = false;
  std::set<std::string, std::less<>> told_;
};

}  // namespace coxa::app
