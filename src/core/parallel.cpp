#include <coxa/core/parallel.h>

#include <coxa/core/error.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>

namespace coxa {
namespace {

// chunks per loop: enough to balance a few dozen threads, few enough to keep the overhead small
constexpr std::int64_t kChunks = 256;

std::atomic<int>& requested_threads() {
  static std::atomic<int> count{oneapi::tbb::info::default_concurrency()};
  return count;
}

/// Threads kept between loops: making them anew would cost more than a short loop.
struct Crew {
  explicit Crew(int n)
      : limit(oneapi::tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(n)),
        arena(n) {}

  // more threads than cores are allowed on request, so that tests can witness independence of the
  // count
  oneapi::tbb::global_control limit;
  oneapi::tbb::task_arena arena;
};

/// The crew of the thread count asked for; a loop that is still running keeps its own alive.
std::shared_ptr<Crew> current_crew() {
  static std::mutex mutex;
  static std::shared_ptr<Crew> crew;
  static int size = 0;
  const std::lock_guard lock(mutex);
  if (const int wanted = thread_count(); !crew || size != wanted) {
    crew.reset();
    crew = std::make_shared<Crew>(wanted);
    size = wanted;
  }
  return crew;
}

}  // namespace

void set_thread_count(int n) {
  require(n >= 1, "thread count must be at least 1, got ", n);
  requested_threads() = n;
}

int thread_count() { return requested_threads(); }

namespace detail {

std::int64_t chunk_size(std::int64_t n) {
  return std::max<std::int64_t>(1, (n + kChunks - 1) / kChunks);
}

void run_chunks(std::int64_t n_chunks, const std::function<void(std::int64_t)>& body) {
  if (n_chunks <= 1 || thread_count() == 1) {
    for (std::int64_t chunk = 0; chunk < n_chunks; ++chunk) body(chunk);
    return;
  }
  current_crew()->arena.execute(
      [&] { oneapi::tbb::parallel_for(std::int64_t{0}, n_chunks, body); });
}

}  // namespace detail
}  // namespace coxa
