#include "job_runner.h"

#include <coxa/core/error.h>

#include <boost/asio/post.hpp>
#include <chrono>

namespace coxa::serve {
namespace {
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr double kBetweenReports = 0.15;  // s
constexpr double kLeastShare = 0.02;      // below it the time left is a guess

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

JobRunner::~JobRunner() {
  cancel_ = true;
  thread_.join();
}

Json JobRunner::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void JobRunner::update(const std::function<void(Json&)>& change) {
  Json copy;
  {
    const std::lock_guard lock(mutex_);
    change(state_);
    copy = state_;
  }
  publish_(copy);
}

std::string JobRunner::start(const std::string& name, std::function<void(const Monitor&)> body) {
  {
    const std::lock_guard lock(mutex_);
    if (state_["state"] == "running")
      return "a job is running already: " + state_["job"].get<std::string>();
    state_ = {{"type", "job"}, {"job", name},    {"state", "running"},       {"stage", ""},
              {"share", 0.0},  {"seconds", 0.0}, {"warnings", Json::array()}};
    cancel_ = false;
  }
  boost::asio::post(thread_, [this, body = std::move(body)] { run(body); });
  return "";
}

void JobRunner::run(const std::function<void(const Monitor&)>& body) {
  const auto start = Clock::now();
  double reported = -kBetweenReports;
  Monitor monitor;
  monitor.cancel_flag = &cancel_;
  monitor.on_progress = [&](std::string_view stage, double share) {
    const double now = seconds_since(start);
    if (now - reported < kBetweenReports) return;
    reported = now;
    update([&](Json& state) {
      state["stage"] = stage;
      state["share"] = share;
      state["seconds"] = now;
      if (share > kLeastShare) state["seconds_left"] = now * (1.0 - share) / share;
    });
  };
  monitor.on_warning = [&](std::string_view text) {
    update([&](Json& state) { state["warnings"].push_back(text); });
  };
  std::string end = "done", text;
  try {
    body(monitor);
  } catch (const Error& error) {
    end = error.code() == ErrorCode::cancelled ? "cancelled" : "failed";
    text = error.what();
  } catch (const std::exception& error) {
    end = "failed";
    text = std::string("internal error: ") + error.what();
  }
  update([&](Json& state) {
    state["state"] = end;
    state["text"] = text;
    state["seconds"] = seconds_since(start);
    state["share"] = end == "done" ? 1.0 : state["share"].get<double>();
    state.erase("seconds_left");
  });
}

}  // namespace coxa::serve
