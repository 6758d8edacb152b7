#pragma once

#include <coxa/core/monitor.h>
#include <coxa/pipeline/record.h>

#include <cstdint>
#include <memory>
#include <set>
#include <string>

namespace coxa::app {

/// Flags every verb understands.
struct CommonOptions {
  int threads = 0;         ///< 0: as many as the machine has
  std::uint64_t seed = 1;  ///< of everything random
  bool json = false;       ///< progress, result and errors as JSON lines on standard output
  bool quiet = false;      ///< errors and the result only
  bool verbose = false;    ///< log: when each step began, and the records in full
};

class ProgressPrinter;

/// What a verb needs from the command line's surroundings.
class Context {
 public:
  Context();
  ~Context();
  CommonOptions common;

  /// Reports progress and warnings to the terminal; carries the Ctrl-C flag.
  Monitor monitor();
  /// With -v: what a stage was asked, read, found and took, to standard error; a JSON line with
  /// --json. Each record once.
  void log_record(const pipeline::Record& record);
  /// Prints the closing lines of a verb: where the result is, and its figures.
  void print_result(const std::string& where, const pipeline::Record& record);
  /// The verb's result itself, as it is.
  void print_text(const std::string& text);
  /// One line for people; nothing with --quiet or --json.
  void say(const std::string& line);
  /// Where something can be reached, printed at once: {"address": …} with --json.
  void announce(const std::string& address, const std::string& line);
  /// Prints an error and returns the exit code.
  int print_error(std::string_view code_name, const std::string& text, int exit_code);

 private:
  std::unique_ptr<ProgressPrinter> progress_;
  std::set<std::string> logged_;  ///< keys of the records told
};

}  // namespace coxa::app
