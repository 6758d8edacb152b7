#pragma once

#include <coxa/core/types.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

namespace coxa {

/// Limits all parallel work of the process to `n` threads (n >= 1) until called again.
void set_thread_count(int n);

/// Threads that parallel work may use now.
int thread_count();

namespace detail {
/// Runs body(chunk) for each chunk in [0, n_chunks), on several threads.
void run_chunks(std::int64_t n_chunks, const std::function<void(std::int64_t)>& body);
/// Iterations per chunk: a function of n only, so that results do not depend on the thread count.
std::int64_t chunk_size(std::int64_t n);
}  // namespace detail

/// Calls body(i) for every i in [0, n); iteration i may only write its own slot.
template <class Body>
void parallel_for(std::int64_t n, const Body& body) {
  const std::int64_t size = detail::chunk_size(n);
  if (n <= 0) return;
  detail::run_chunks((n + size - 1) / size, [&](std::int64_t chunk) {
    const std::int64_t end = std::min(n, (chunk + 1) * size);
    for (std::int64_t i = chunk * size; i < end; ++i) body(static_cast<Index>(i));
  });
}

/// Combines map(i) over [0, n) with `combine(accumulated, value)`, in an order that is the same
/// for any number of threads.
template <class T, class Map, class Combine>
T parallel_reduce(std::int64_t n, const T& identity, const Map& map, const Combine& combine) {
  const std::int64_t size = detail::chunk_size(n);
  if (n <= 0) return identity;
  std::vector<T> partial(static_cast<std::size_t>((n + size - 1) / size), identity);
  detail::run_chunks(static_cast<std::int64_t>(partial.size()), [&](std::int64_t chunk) {
    T sum = identity;
    const std::int64_t end = std::min(n, (chunk + 1) * size);
    for (std::int64_t i = chunk * size; i < end; ++i)
      sum = combine(std::move(sum), map(static_cast<Index>(i)));
    partial[static_cast<std::size_t>(chunk)] = std::move(sum);
  });
  T total = identity;
  for (T& part : partial) total = combine(std::move(total), std::move(part));
  return total;
}

/// Calls f() with the thread count set to n, restores the count, and returns f's result.
template <class F>
auto with_threads(int n, const F& f) -> std::invoke_result_t<F> {
  struct Restore {
    int count;
    ~Restore() { set_thread_count(count); }
  } restore{thread_count()};
  set_thread_count(n);
  return f();
}

}  // namespace coxa
