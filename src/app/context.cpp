#include "context.h"

#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "progress_printer.h"

namespace coxa::app {
namespace {

// the signal handler can reach nothing else
std::atomic<bool> interrupted{false};

extern "C" void on_interrupt(int) {
  // a second Ctrl-C ends the process at once
  if (interrupted.exchange(true)) _exit(130);
}

ProgressStyle style_for(const CommonOptions& common) {
  if (common.json) return ProgressStyle::json;
  if (common.quiet) return ProgressStyle::silent;
  if (common.verbose) return ProgressStyle::log;
  return isatty(STDERR_FILENO) ? ProgressStyle::terminal : ProgressStyle::lines;
}

nlohmann::json as_json(const pipeline::Value& value) {
  return std::visit([](const auto& v) { return nlohmann::json(v); }, value);
}

std::string as_text(const pipeline::Value& value) {
  if (const double* number = std::get_if<double>(&value)) return fmt::format("{:.4g}", *number);
  if (const std::string* text = std::get_if<std::string>(&value)) return *text;
  return as_json(value).dump();
}

}  // namespace

Context::Context() = default;
Context::~Context() = default;

Monitor Context::monitor() {
  if (!progress_) {
    progress_ = std::make_unique<ProgressPrinter>(style_for(common));
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
  }
  Monitor monitor;
  monitor.on_progress = [this](std::string_view stage, double share) {
    progress_->update(stage, share);
  };
  monitor.on_warning = [this](std::string_view text) { progress_->warn(text); };
  monitor.cancel_flag = &interrupted;
  return monitor;
}

void Context::log_record(const pipeline::Record& record) {
  if (!common.verbose || record.verb.empty()) return;
  if (!logged_.insert(record.verb + pipeline::record_key(record)).second) return;
  if (progress_) progress_->finish_line();
  if (common.json) {
    const nlohmann::json json = nlohmann::json::parse(pipeline::to_json(record));
    fmt::print("{}\n", nlohmann::json{{"record", json}}.dump());
    return;
  }
  fmt::print(stderr, "{}: {:.2f} s, at most {:.0f} MB, key {:.12}\n", record.verb, record.seconds,
             record.peak_memory_mb, pipeline::record_key(record));
  for (const auto& [key, value] : record.options)
    fmt::print(stderr, "  option  {:<44} {}\n", key, as_text(value));
  for (const auto& [role, hash] : record.inputs)
    fmt::print(stderr, "  input   {:<44} {:.12}\n", role, hash);
  for (const auto& [key, value] : record.figures)
    fmt::print(stderr, "  figure  {:<44} {}\n", key, as_text(value));
  for (const std::string& text : record.warnings) fmt::print(stderr, "  warning {}\n", text);
}

void Context::print_result(const std::string& where, const pipeline::Record& record) {
  log_record(record);
  if (progress_) progress_->finish_line();
  if (common.json) {
    nlohmann::json figures = nlohmann::json::object();
    for (const auto& [key, value] : record.figures) figures[key] = as_json(value);
    fmt::print("{}\n", nlohmann::json{{"result", where}, {"figures", figures}}.dump());
    return;
  }
  fmt::print("{}\n", where);
  if (common.quiet) return;
  for (const auto& [key, value] : record.figures) fmt::print("  {:<44} {}\n", key, as_text(value));
}

void Context::print_text(const std::string& text) { fmt::print("{}", text); }

void Context::say(const std::string& line) {
  if (progress_) progress_->finish_line();
  if (!common.quiet && !common.json) fmt::print("{}\n", line);
}

void Context::announce(const std::string& address, const std::string& line) {
  fmt::print("{}\n", common.json ? nlohmann::json{{"address", address}}.dump() : line);
  std::fflush(stdout);
}

int Context::print_error(std::string_view code_name, const std::string& text, int exit_code) {
  if (progress_) progress_->finish_line();
  if (common.json) {
    fmt::print("{}\n", nlohmann::json{{"error", {{"code", code_name}, {"text", text}}}}.dump());
  } else {
    fmt::print(stderr, "coxa: {}\n", text);
  }
  return exit_code;
}

}  // namespace coxa::app
