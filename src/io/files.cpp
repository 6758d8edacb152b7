#include <coxa/io/files.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace coxa::io {
namespace {

namespace fs = std::filesystem;

std::string system_reason(int error) { return std::strerror(error); }

/// A file beside `path` that vanishes unless it is renamed into its place.
class PartialFile {
 public:
  explicit PartialFile(const fs::path& path) : path_(path) {
    partial_ =
        path.parent_path() / join_text('.', path.filename().string(), ".partial-", ::getpid());
    descriptor_ = ::open(partial_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) give_up(errno);
  }
  ~PartialFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!partial_.empty()) ::unlink(partial_.c_str());
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) give_up(errno);
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }
  void move_into_place() {
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) give_up(errno);
    if (::rename(partial_.c_str(), path_.c_str()) != 0) give_up(errno);
    partial_.clear();
  }

 private:
  [[noreturn]] void give_up(int error) const {
    fail(ErrorCode::bad_file, "cannot write ", path_.string(), ": ", system_reason(error),
         error == ENOSPC || error == EDQUOT ? "; free some space or write elsewhere" : "");
  }
  fs::path path_, partial_;
  int descriptor_ = -1;
};

}  // namespace

std::string read_bytes(const fs::path& path) {
  std::error_code status;
  if (!fs::exists(path, status)) fail(ErrorCode::bad_file, path.string(), " does not exist");
  if (fs::is_directory(path, status)) {
    fail(ErrorCode::bad_file, path.string(), " is a folder, a file is needed");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(ErrorCode::bad_file, "cannot open ", path.string(), ": ", system_reason(errno));
  std::ostringstream bytes;
  if (file.peek() != std::ifstream::traits_type::eof()) bytes << file.rdbuf();
  if (file.bad() || bytes.bad()) fail(ErrorCode::bad_file, "cannot read ", path.string());
  return std::move(bytes).str();
}

void write_bytes(const fs::path& path, std::string_view bytes) {
  if (path.has_parent_path()) {
    std::error_code status;
    fs::create_directories(path.parent_path(), status);
    if (status) {
      fail(ErrorCode::bad_file, "cannot make the folder of ", path.string(), ": ",
           status.message());
    }
  }
  PartialFile file(path);
  file.write(bytes);
  file.move_into_place();
}

std::string extension_of(const fs::path& path) {
  std::string file = path.filename().string();
  std::transform(file.begin(), file.end(), file.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* doubled : {".nii.gz", ".seg.nrrd", ".mrk.json"}) {
    if (file.size() > std::strlen(doubled) && file.ends_with(doubled)) return doubled;
  }
  return fs::path(file).extension().string();
}

std::string stem_of(const fs::path& path) {
  const std::string file = path.filename().string();
  return file.substr(0, file.size() - extension_of(path).size());
}

}  // namespace coxa::io
