#include <coxa/io/collection.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>

#include <algorithm>
#include <sstream>

namespace coxa::io {
namespace {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '"') {
      result += "&quot;";
    } else {
      result += c;
    }
  }
  return result;
}

}  // namespace

void write_collection(const std::filesystem::path& path,
                      const std::vector<CollectionEntry>& entries) {
  std::vector<std::string> parts;
  std::ostringstream text;
  text.precision(12);
  text << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
          "byte_order=\"LittleEndian\">\n"
       << "<Collection>\n";
  for (const CollectionEntry& entry : entries) {
    require(entry.file.is_relative() && std::filesystem::exists(path.parent_path() / entry.file),
            "file ", entry.file.string(), " of the collection ", path.string(),
            " must lie beside it");
    auto part = std::find(parts.begin(), parts.end(), entry.part);
    if (part == parts.end()) part = parts.insert(part, entry.part);
    text << "<DataSet timestep=\"" << entry.time << "\" part=\"" << part - parts.begin()
         << "\" name=\"" << escaped(entry.part) << "\" file=\""
         << escaped(entry.file.generic_string()) << "\"/>\n";
  }
  text << "</Collection>\n</VTKFile>\n";
  write_bytes(path, text.str());
}

}  // namespace coxa::io
