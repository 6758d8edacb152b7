#include "write_whole.h"

#include <coxa/core/error.h>

#include <fstream>
#include <system_error>

namespace coxa::view {

void write_whole(const std::filesystem::path& path, std::string_view bytes) {
  std::filesystem::path unfinished = path;
  unfinished += ".part";
  std::ofstream file(unfinished, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(unfinished, path, error);
  if (!file || error) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    fail(ErrorCode::bad_file, "cannot write ", path.string());
  }
}

}  // namespace coxa::view
