#pragma once

#include <coxa/core/parallel.h>

#include <algorithm>

namespace coxa::solve {

// the fewest block rows worth a task of their own, and the most tasks; functions of n only, so that
// sums do not depend on the number of threads
inline constexpr Index kRowsPerTask = 256;
inline constexpr Index kMaxTasks = 64;

/// Tasks that n block rows are cut into.
inline Index task_count(Index n) { return std::clamp<Index>(n / kRowsPerTask, 1, kMaxTasks); }

/// Calls body(task, begin, end) for each task's range of rows; a small system runs as one task,
/// without threads.
template <class Body>
void for_row_ranges(Index n, const Body& body) {
  const Index tasks = task_count(n);
  parallel_for(tasks, [&](Index task) {
    body(task, static_cast<Index>(std::int64_t{n} * task / tasks),
         static_cast<Index>(std::int64_t{n} * (task + 1) / tasks));
  });
}

/// Calls body(row) for every row.
template <class Body>
void for_rows(Index n, const Body& body) {
  for_row_ranges(n, [&](Index, Index begin, Index end) {
    for (Index row = begin; row < end; ++row) body(row);
  });
}

}  // namespace coxa::solve
