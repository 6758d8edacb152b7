#include <coxa/pipeline/stage.h>

#include <coxa/core/error.h>

#include <chrono>
#include <system_error>

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

bool holds_result(const fs::path& folder, const Record& wanted) {
  const fs::path file = folder / (wanted.verb + ".json");
  if (!fs::exists(file)) return false;
  try {
    return record_key(read_record(file)) == record_key(wanted);
  } catch (const Error&) {
    return false;  // a broken record is no ground for keeping a result
  }
}

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

}  // namespace

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

  const auto start = std::chrono::steady_clock::now();
  body(partial, wanted);
  wanted.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  wanted.peak_memory_mb = peak_memory_mb();
  write_record(partial / file, wanted);
  put_in_place(partial, folder);
  monitor.progress(wanted.verb, 1.0);
  return wanted;
}

}  // namespace coxa::pipeline
