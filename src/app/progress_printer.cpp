#include "progress_printer.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>

namespace coxa::app {
namespace {
using Clock = std::chrono::steady_clock;
// piped output gets a line for every tenth, a terminal a fresh line five times a second
constexpr double kLineShare = 0.1, kLogShare = 0.01;
constexpr double kTerminalSeconds = 0.2;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}
}  // namespace

double ProgressPrinter::seconds_left(double share) const {
  const double done = share - first_share_;
  return done > 0.01 ? seconds_since(stage_start_) * (1.0 - share) / done : -1.0;
}

bool ProgressPrinter::worth_printing(std::string_view stage, double share) const {
  if (stage != stage_ || (share >= 1.0 && printed_share_ < 1.0)) return true;
  if (style_ == ProgressStyle::terminal) return seconds_since(printed_at_) > kTerminalSeconds;
  return share >= printed_share_ + (style_ == ProgressStyle::log ? kLogShare : kLineShare);
}

void ProgressPrinter::update(std::string_view stage, double share) {
  if (style_ == ProgressStyle::silent || !worth_printing(stage, share)) return;
  if (stage != stage_) {
    stage_ = stage;
    first_share_ = share;
    stage_start_ = Clock::now();
  }
  printed_share_ = share;
  printed_at_ = Clock::now();
  const double left = seconds_left(share);
  if (style_ == ProgressStyle::json) {
    nlohmann::json line{{"stage", stage_}, {"share", std::round(share * 1e4) / 1e4}};
    if (left >= 0.0) line["seconds_left"] = std::round(left * 10.0) / 10.0;
    fmt::print("{}\n", nlohmann::json{{"progress", line}}.dump());
  } else {
    const std::string time = left >= 0.5 ? fmt::format(", {:.0f} s left", left) : "";
    const std::string text = fmt::format("{}: {:3.0f} %{}", stage_, 100.0 * share, time);
    if (style_ == ProgressStyle::terminal) {
      fmt::print(stderr, "\r{:<70}", text);
      line_open_ = true;
      if (share >= 1.0) finish_line();
    } else if (style_ == ProgressStyle::log) {
      fmt::print(stderr, "{:8.2f} s  {}\n", seconds_since(start_), text);
    } else {
      fmt::print(stderr, "{}\n", text);
    }
  }
  std::fflush(style_ == ProgressStyle::json ? stdout : stderr);
}

void ProgressPrinter::warn(std::string_view text) {
  if (!told_.emplace(text).second) return;
  finish_line();
  if (style_ == ProgressStyle::json) {
    fmt::print("{}\n", nlohmann::json{{"warning", text}}.dump());
  } else {
    fmt::print(stderr, "warning: {}\n", text);
  }
}

void ProgressPrinter::finish_line() {
  if (line_open_) fmt::print(stderr, "\n");
  line_open_ = false;
}

}  // namespace coxa::app
