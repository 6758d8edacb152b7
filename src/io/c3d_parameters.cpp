#include "c3d_parameters.h"

#include <coxa/core/error.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdlib>
#include <tuple>

namespace coxa::io {

void C3dBytes::check(std::size_t at, std::size_t length) const {
  if (at + length > bytes_.size()) {
    fail(ErrorCode::bad_file, name_, ": the file is cut short: byte ", at + length,
         " is needed, it has ", bytes_.size());
  }
}

std::uint8_t C3dBytes::byte(std::size_t at) const {
  check(at, 1);
  return bytes_[at];
}

std::uint16_t C3dBytes::word(std::size_t at) const {
  check(at, 2);
  const unsigned low = bytes_[at], high = bytes_[at + 1];
  return static_cast<std::uint16_t>(processor_ == C3dProcessor::sgi ? low << 8 | high
                                                                    : high << 8 | low);
}

double C3dBytes::real(std::size_t at) const {
  check(at, 4);
  const std::uint32_t b0 = bytes_[at], b1 = bytes_[at + 1], b2 = bytes_[at + 2],
                      b3 = bytes_[at + 3];
  if (processor_ == C3dProcessor::sgi)
    return std::bit_cast<float>(b0 << 24 | b1 << 16 | b2 << 8 | b3);
  if (processor_ == C3dProcessor::intel)
    return std::bit_cast<float>(b3 << 24 | b2 << 16 | b1 << 8 | b0);
  // DEC F-float: words in reversed order, exponent biased by two more than IEEE; exponent 0 is zero
  const std::uint32_t bits = b1 << 24 | b0 << 16 | b3 << 8 | b2;
  if ((bits & 0x7f800000u) == 0) return 0.0;
  return static_cast<double>(std::bit_cast<float>(bits)) / 4.0;
}

std::string C3dBytes::text(std::size_t at, std::size_t length) const {
  check(at, length);
  std::string result(bytes_.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes_.begin() + static_cast<std::ptrdiff_t>(at + length));
  result = result.substr(0, result.find('\0'));
  while (!result.empty() && std::isspace(static_cast<unsigned char>(result.back())))
    result.pop_back();
  return result;
}

namespace {

std::string capitals(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

// value block of a parameter, which starts at `at`: type, number of sizes, sizes, data
C3dParameter read_value(const C3dBytes& file, std::size_t at, std::size_t limit) {
  C3dParameter parameter;
  const int type = static_cast<std::int8_t>(file.byte(at));
  const std::size_t n_sizes = file.byte(at + 1);
  at += 2;
  if (n_sizes > 7) fail(ErrorCode::bad_file, "a parameter with ", n_sizes, " sizes (at most 7)");
  std::size_t count = 1;
  for (std::size_t k = 0; k < n_sizes; ++k) {
    parameter.sizes.push_back(file.byte(at++));
    count *= static_cast<std::size_t>(parameter.sizes.back());
  }
  if (type != -1 && type != 1 && type != 2 && type != 4) {
    fail(ErrorCode::bad_file, "a parameter of the unknown type ", type);
  }
  const std::size_t end = at + count * static_cast<std::size_t>(std::abs(type));
  if (end > limit) {
    fail(ErrorCode::bad_file, "a parameter that ends at byte ", end,
         ", beyond the section's end at ", limit);
  }
  if (type == -1) {
    parameter.is_text = true;
    const std::size_t length =
        parameter.sizes.empty() ? 1 : static_cast<std::size_t>(parameter.sizes.front());
    for (std::size_t k = 0; length > 0 && k < count / length; ++k) {
      parameter.texts.push_back(file.text(at + k * length, length));
    }
    return parameter;
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t place = at + k * static_cast<std::size_t>(type);
    parameter.numbers.push_back(type == 1   ? static_cast<std::int8_t>(file.byte(place))
                                : type == 2 ? file.integer(place)
                                            : file.real(place));
  }
  return parameter;
}

bool is_name(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return c >= 32 && c < 127; });
}

}  // namespace

C3dParameters read_c3d_parameters(const C3dBytes& file, std::size_t start, std::size_t limit,
                                  std::vector<std::string>& warnings) {
  std::map<int, std::string> groups;
  std::vector<std::tuple<int, std::string, C3dParameter>> found;
  std::size_t at = start + 4;
  try {
    while (at < limit) {
      const int length = std::abs(static_cast<std::int8_t>(file.byte(at)));
      const int group = static_cast<std::int8_t>(file.byte(at + 1));
      if (length == 0 || group == 0) break;
      const std::string name = capitals(file.text(at + 2, static_cast<std::size_t>(length)));
      if (!is_name(name)) fail(ErrorCode::bad_file, "a name that is not text");
      const std::size_t offset_at = at + 2 + static_cast<std::size_t>(length);
      const std::size_t offset = file.word(offset_at);
      if (group < 0) {
        groups[-group] = name;
      } else {
        found.emplace_back(group, name, read_value(file, offset_at + 2, limit));
      }
      if (offset == 0) break;  // the last one
      at = offset_at + offset;
    }
  } catch (const Error& error) {
    warnings.push_back(join_text("the parameter section is broken at byte ", at, " (", error.what(),
                                 "); what stands before it is used"));
  }
  C3dParameters parameters;
  for (auto& [group, name, parameter] : found) {
    const auto it = groups.find(group);
    const std::string key = (it == groups.end() ? "?" : it->second) + ":" + name;
    parameters.emplace(key, std::move(parameter));
  }
  return parameters;
}

}  // namespace coxa::io
