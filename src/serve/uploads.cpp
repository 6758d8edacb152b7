#include "uploads.h"

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/pipeline/segment_stage.h>

#include <algorithm>
#include <cctype>

namespace coxa::serve {
namespace fs = std::filesystem;
namespace {
using Json = nlohmann::json;

constexpr std::size_t kMostBatches = 2;   // the oldest gives way: its window has probably gone
constexpr std::size_t kHeader = 1 << 16;  // bytes in which a header must end

bool is_batch_name(const std::string& name) {
  return name.size() >= 8 && name.size() <= 32 && std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Headers of NRRD and MetaImage can name other files as their voxels: such would be read from
/// anywhere on this machine.
void require_own_voxels(const std::string& extension, const std::string& bytes) {
  std::string header = lower_case(bytes.substr(0, kHeader));
  if (extension == ".nrrd") {
    const std::size_t end = std::min(header.find("\n\n"), header.find("\r\n\r\n"));
    header = header.substr(0, end);
    require(header.find("data file") == std::string::npos &&
                header.find("datafile") == std::string::npos,
            "an NRRD whose voxels lie in another file cannot be sent");
  } else if (extension == ".mha") {
    const std::size_t at = header.find("elementdatafile");
    const std::size_t end = header.find('\n', at);
    require(at != std::string::npos && end != std::string::npos &&
                header.substr(at, end - at).find("local") != std::string::npos,
            "a MetaImage whose voxels lie in another file cannot be sent");
  }
}

}  // namespace

Uploads::Uploads(const CaseFolder& folder)
    : folder_(folder), waiting_(folder.folder() / ".upload.partial") {
  std::error_code ignored;
  fs::remove_all(waiting_, ignored);  // of a server that was killed
}

Uploads::~Uploads() {
  std::error_code ignored;
  fs::remove_all(waiting_, ignored);
}

fs::path Uploads::place(const std::string& batch) const { return waiting_ / batch; }

void Uploads::drop(const std::string& name) {
  std::error_code ignored;
  fs::remove_all(place(name), ignored);
  batches_.remove_if([&](const Batch& batch) { return batch.name == name; });
}

Uploads::Batch& Uploads::batch(const std::string& name) {
  require(is_batch_name(name), "an upload needs a name of 8 to 32 hexadecimal digits");
  for (Batch& known : batches_) {
    if (known.name == name) return known;
  }
  if (batches_.size() >= kMostBatches) drop(std::string(batches_.front().name));
  return batches_.emplace_back(Batch{name});
}

void Uploads::require_no_image() const {
  const CaseInput in = folder_.input();
  require(in.images.empty(),
          "this subject has an image already; another needs a folder of its own");
  require(!fs::exists(folder_.folder() / "subject.toml"),
          "subject.toml names another image: ", in.fault);
}

Json Uploads::add(const std::string& name, const std::string& file, const std::string& bytes) {
  require_no_image();
  Batch& known = batch(name);
  const bool whole = is_image(lower_case(file));
  const std::string extension = whole ? io::extension_of(lower_case(file)) : ".dcm";
  try {
    require(extension != ".mhd", "send .mha, .nrrd or .nii.gz: .mhd keeps its voxels elsewhere");
    require(!bytes.empty() && bytes.size() <= kLargestFile, "a file may have up to ", kLargestFile,
            " bytes");
    require(known.bytes + bytes.size() <= kLargestBatch && known.files < kMostFiles,
            "an image may have up to ", kLargestBatch, " bytes in ", kMostFiles, " files");
    require(known.files == 0 || (known.image.empty() && !whole),
            "send either one image file or the files of one DICOM folder");
    require_own_voxels(extension, bytes);
    char number[16];
    std::snprintf(number, sizeof number, "%05d", known.files);
    const std::string stored = whole ? "image" + extension : number + extension;
    io::write_bytes(place(name) / stored, bytes);
    known.bytes += bytes.size();
    known.files += 1;
    if (whole) known.image = stored;
  } catch (const Error&) {
    drop(name);
    throw;
  }
  return {{"files", known.files}, {"bytes", known.bytes}};
}

Json Uploads::take(const Json& wanted) {
  const auto name = wanted.at("batch").get<std::string>();
  const auto side = wanted.at("side").get<std::string>();
  const auto movement = wanted.at("movement").get<std::string>();
  require(side == "left" || side == "right", "the side must be left or right");
  require(fs::path(movement).filename() == movement &&
              fs::exists(pipeline::shipped_data("movements/" + movement + ".toml")),
          "there is no movement \"", movement, "\"");
  require_no_image();
  const Batch known = batch(name);
  require(known.files > 0, "nothing was sent");
  pipeline::ImageEntry entry{place(name) / known.image, std::nullopt};
  if (known.image.empty()) entry.path = place(name);
  if (const auto series = wanted.value("series", std::string()); !series.empty())
    entry.series = series;
  const std::string target = known.image.empty() ? "dicom" : known.image;
  try {
    pipeline::read_image(entry, {}, {});
  } catch (const std::exception&) {
    // several series can still be chosen from; anything else is no image
    if (!known.image.empty() || entry.series) drop(name);
    throw;
  }
  fs::rename(entry.path, folder_.folder() / target);
  std::string text = join_text("name = ", Json(folder_.folder().filename().string()).dump(),
                               "\nside = \"", side, "\"\n\n[image]\npath = \"", target, "\"\n");
  if (entry.series) text += join_text("series = ", Json(*entry.series).dump(), "\n");
  text += join_text("\n[motion]\npattern = \"", movement, "\"\n");
  io::write_bytes(folder_.folder() / "subject.toml", text);
  drop(name);
  return {{"image", target}};
}

}  // namespace coxa::serve
