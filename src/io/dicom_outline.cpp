#include "dicom_outline.h"

#include <coxa/core/error.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>

namespace coxa::io {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kUndefinedLength = 0xFFFFFFFF;
constexpr std::uint32_t kTransferSyntax = 0x00020010, kPixelData = 0x7FE00010;
constexpr std::uint32_t kSamples = 0x00280002, kFrames = 0x00280008, kRows = 0x00280010,
                        kColumns = 0x00280011, kBits = 0x00280100;
constexpr std::uint32_t kItemEnd = 0xFFFEE00D, kSequenceEnd = 0xFFFEE0DD;
constexpr std::uint64_t kPreamble = 132;  // 128 bytes and "DICM"
constexpr int kDeepest = 32;              // sequences within sequences; more is a broken file
constexpr std::uint32_t kShortText = 64;  // no value that is looked at is longer

/// The file ends within what is being read.
struct CutShort {};

struct Element {
  std::uint32_t tag = 0;
  std::uint32_t length = 0;
  bool unknown_type = false;  ///< value representation UN: its items are written without types
};

/// How the elements after the file's meta group are written.
enum class Encoding { explicit_types, implicit_types, not_walkable };

class Walker {
 public:
  explicit Walker(const fs::path& file)
      : stream_(file, std::ios::binary), size_(fs::file_size(file)) {
    skip(kPreamble);
  }

  /// Head of the element that begins here; its value comes next.
  Element next(bool explicit_types) {
    const std::uint32_t group = number(2);
    const std::uint32_t tag = group << 16 | number(2);
    if (group == 0xFFFE || !explicit_types) return {tag, number(4)};
    const std::string type = text(2);
    // these have two reserved bytes and a long length: PS3.5 table 7.1-1
    static const std::set<std::string> kLong = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                "SV", "UC", "UN", "UR", "UT", "UV"};
    if (!kLong.contains(type)) return {tag, number(2)};
    skip(2);
    return {tag, number(4), type == "UN"};
  }

  /// Past the value of an element whose head was read.
  void pass(const Element& element, bool explicit_types, int depth = 0) {
    if (element.length != kUndefinedLength) return skip(element.length);
    if (depth > kDeepest) throw CutShort{};
    explicit_types = explicit_types && !element.unknown_type;
    for (Element item = next(explicit_types); item.tag != kSequenceEnd;
         item = next(explicit_types)) {
      if (item.length == kUndefinedLength) {
        for (Element inner = next(explicit_types); inner.tag != kItemEnd;
             inner = next(explicit_types))
          pass(inner, explicit_types, depth + 1);
      } else {
        skip(item.length);
      }
    }
  }

  std::uint32_t group_ahead() {
    const std::uint32_t group = number(2);
    at_ -= 2;
    stream_.seekg(static_cast<std::streamoff>(at_));
    return group;
  }
  std::uint32_t number(std::size_t bytes) {
    const std::string raw = text(bytes);
    std::uint32_t value = 0;
    for (std::size_t k = bytes; k-- > 0;) value = value << 8 | static_cast<unsigned char>(raw[k]);
    return value;
  }
  std::string text(std::size_t bytes) {
    if (left() < bytes) throw CutShort{};
    std::string raw(bytes, '\0');
    stream_.read(raw.data(), static_cast<std::streamsize>(bytes));
    at_ += bytes;
    return raw;
  }
  void skip(std::uint64_t bytes) {
    if (bytes > left()) throw CutShort{};
    at_ += bytes;
    stream_.seekg(static_cast<std::streamoff>(at_));
  }
  std::uint64_t left() const { return size_ - at_; }

 private:
  std::ifstream stream_;
  std::uint64_t size_ = 0, at_ = 0;
};

Encoding encoding_of(std::string syntax) {
  while (!syntax.empty() && (syntax.back() == '\0' || syntax.back() == ' ')) syntax.pop_back();
  if (syntax == "1.2.840.10008.1.2") return Encoding::implicit_types;
  if (syntax == "1.2.840.10008.1.2.2" || syntax == "1.2.840.10008.1.2.1.99")
    return Encoding::not_walkable;
  return Encoding::explicit_types;  // plain, and all that compress the pixels alone
}

/// The values of a file that say how many bytes its pixels take.
class PixelSize {
 public:
  /// Reads the element's value if it is one of them. @returns whether it was
  bool take(Walker& walker, const Element& element) {
    if (!values_.contains(element.tag)) return false;
    if (element.tag == kFrames) {
      const std::string count = walker.text(std::min(element.length, kShortText));
      values_[kFrames] = std::strtoull(count.c_str(), nullptr, 10);
    } else {
      values_[element.tag] = walker.number(2);
      walker.skip(element.length - std::min<std::uint32_t>(element.length, 2));
    }
    return true;
  }
  bool is_image() const { return values_.at(kRows) > 0 && values_.at(kColumns) > 0; }
  std::uint64_t bytes() const {
    std::uint64_t product = 1;
    for (const auto& [tag, value] : values_) product *= value;
    return product / 8;
  }

 private:
  std::map<std::uint32_t, std::uint64_t> values_ = {
      {kSamples, 1}, {kFrames, 1}, {kRows, 0}, {kColumns, 0}, {kBits, 16}};
};

std::string fault_of_pixels(Walker& walker, const Element& pixels, std::uint64_t needed) {
  if (pixels.length == kUndefinedLength) {
    walker.pass(pixels, true);  // compressed fragments are items: the walk throws where one is cut
    return "";
  }
  if (pixels.length > walker.left()) {
    return join_text("is cut short: its pixels take ", pixels.length, " bytes and ", walker.left(),
                     " are there");
  }
  if (pixels.length < needed) {
    return join_text("has too few pixels: ", pixels.length, " bytes where its size needs ", needed);
  }
  return "";
}

/// Past the elements of group 2, which are always written with types.
Encoding pass_meta_group(Walker& walker) {
  Encoding encoding = Encoding::explicit_types;
  while (walker.left() > 0 && walker.group_ahead() == 2) {
    const Element element = walker.next(true);
    if (element.tag == kTransferSyntax) {
      encoding = encoding_of(walker.text(std::min(element.length, kShortText)));
    } else {
      walker.skip(element.length);
    }
  }
  return encoding;
}

/// Fills the outline as it walks; what it has when the file ends stays.
void walk(const fs::path& file, DicomOutline& outline) {
  Walker walker(file);
  const Encoding encoding = pass_meta_group(walker);
  if (encoding == Encoding::not_walkable) {
    outline.has_image = outline.header_whole = true;
    return;
  }
  const bool explicit_types = encoding == Encoding::explicit_types;
  PixelSize size;
  while (walker.left() > 0) {
    const Element element = walker.next(explicit_types);
    if (element.tag == kPixelData) {
      outline.header_whole = true;
      outline.fault = fault_of_pixels(walker, element, size.bytes());
      return;
    }
    if (!size.take(walker, element)) walker.pass(element, explicit_types);
    outline.has_image = size.is_image();
  }
  outline.header_whole = true;
  if (outline.has_image) outline.fault = "has no pixels: it ends before them";
}

}  // namespace

DicomOutline outline_dicom(const fs::path& file) {
  DicomOutline outline;
  try {
    walk(file, outline);
  } catch (const CutShort&) {
    outline.fault = "is cut short: it ends within a data element";
  }
  return outline;
}

}  // namespace coxa::io
