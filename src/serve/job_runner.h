#pragma once

#include <coxa/core/monitor.h>

#include <atomic>
#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>

namespace coxa::serve {

/// One long job at a time, on a thread of its own, with progress for all to see.
class JobRunner {
 public:
  using Publish = std::function<void(const nlohmann::json&)>;
  explicit JobRunner(Publish publish) : publish_(std::move(publish)) {}
  ~JobRunner();

  /// Begins a job; `body` throws what it fails of.
  /// @returns why it cannot begin; empty when it did
  std::string start(const std::string& name, std::function<void(const Monitor&)> body);
  void cancel() { cancel_ = true; }
  /// The last job: {"type": "job", "job", "state": none, running, done, failed or cancelled,
  /// "stage", "share", "seconds", "seconds_left", "text", "warnings"}.
  nlohmann::json state() const;

 private:
  void run(const std::function<void(const Monitor&)>& body);
  void update(const std::function<void(nlohmann::json&)>& change);

  Publish publish_;
  std::atomic<bool> cancel_{false};
  mutable std::mutex mutex_;
  nlohmann::json state_{{"type", "job"}, {"state", "none"}};
  boost::asio::thread_pool thread_{1};
};

}  // namespace coxa::serve
