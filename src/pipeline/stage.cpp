#include <coxa/pipeline/stage.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <system_error>
#include <vector>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

/// Removes the folder it names unless told to keep it.
class RemoveOnExit {
 public:
  explicit RemoveOnExit(fs::path folder) : folder_(std::move(folder)) {}
  ~RemoveOnExit() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  RemoveOnExit(const RemoveOnExit&) = delete;
  RemoveOnExit& operator=(const RemoveOnExit&) = delete;

 private:
  fs::path folder_;
};

void make_empty_folder(const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
  fs::create_directories(folder, error);
  if (error)
    fail(ErrorCode::bad_file, "cannot make the folder ", folder.string(), ": ", error.message());
}

void put_in_place(const fs::path& partial, const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
  fs::rename(partial, folder, error);
  if (error)
    fail(ErrorCode::bad_file, "cannot put the result at ", folder.string(), ": ", error.message());
}

/// Runs the body in an empty folder and completes the record with time and memory.
void fill(const fs::path& partial, Record& record, const Monitor& monitor,
          const std::function<void(const fs::path&, Record&)>& body) {
  const auto start = std::chrono::steady_clock::now();
  body(partial, record);
  record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  record.peak_memory_mb = peak_memory_mb();
  monitor.check_cancelled();
}

/// Moves every file of `partial` into `folder`; files already moved are taken back when one fails.
void move_files(const fs::path& partial, const fs::path& folder) {
  std::vector<fs::path> names;
  for (const auto& entry : fs::directory_iterator(partial))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::error_code error, ignored;
    fs::rename(partial / names[i], folder / names[i], error);
    if (!error) continue;
    for (std::size_t k = 0; k < i; ++k) fs::remove(folder / names[k], ignored);
    fail(ErrorCode::bad_file, "cannot put ", (folder / names[i]).string(),
         " in place: ", error.message());
  }
}

}  // namespace

bool holds_result(const fs::path& folder, const Record& wanted) {
  const fs::path file = folder / (wanted.verb + ".json");
  if (!fs::exists(file)) return false;
  try {
    return record_key(read_record(file)) == record_key(wanted);
  } catch (const Error&) {
    return false;  // a broken record is no ground for keeping a result
  }
}

Record run_stage(const fs::path& folder, Record wanted, Reuse reuse, const Monitor& monitor,
                 const std::function<void(const fs::path&, Record&)>& body) {
  const std::string file = wanted.verb + ".json";
  if (reuse == Reuse::if_unchanged && holds_result(folder, wanted)) {
    monitor.progress(wanted.verb, 1.0);
    return read_record(folder / file);
  }
  monitor.check_cancelled();
  const fs::path partial = folder.string() + ".partial";
  make_empty_folder(partial);
  const RemoveOnExit cleanup(partial);
  monitor.progress(wanted.verb, 0.0);
  fill(partial, wanted, monitor, body);
  write_record(partial / file, wanted);
  put_in_place(partial, folder);
  monitor.progress(wanted.verb, 1.0);
  return wanted;
}

Record run_file(const fs::path& out, Record wanted, const Monitor& monitor,
                const std::function<void(const fs::path&, Record&)>& body) {
  monitor.check_cancelled();
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  const fs::path partial = folder / join_text('.', io::stem_of(out), ".partial-", ::getpid());
  make_empty_folder(partial);
  const RemoveOnExit cleanup(partial);
  monitor.progress(wanted.verb, 0.0);
  fill(partial, wanted, monitor, body);
  write_record(partial / (io::stem_of(out) + ".json"), wanted);
  move_files(partial, folder);
  monitor.progress(wanted.verb, 1.0);
  return wanted;
}

}  // namespace coxa::pipeline
