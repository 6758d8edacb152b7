#include <coxa/serve/bundle.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <vector>

namespace coxa::serve {
namespace {

constexpr double kSteps = 65534.0;  // of 16 bits, less the one that stands for NaN
constexpr std::uint16_t kNoNumber = 65535;

static_assert(std::endian::native == std::endian::little, "bundles are little-endian");

template <class T>
std::string_view raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

template <class To, class Matrix>
std::vector<To> row_by_row(const Matrix& values) {
  std::vector<To> out;
  out.reserve(static_cast<std::size_t>(values.size()));
  for (Eigen::Index r = 0; r < values.rows(); ++r) {
    for (Eigen::Index c = 0; c < values.cols(); ++c) out.push_back(static_cast<To>(values(r, c)));
  }
  return out;
}

}  // namespace

void Bundle::add_raw(std::string_view name, std::string_view type, std::int64_t rows,
                     std::int64_t columns, std::string_view raw, std::string_view more) {
  list_ += join_text(list_.empty() ? "" : ",", "{\"name\":\"", name, "\",\"type\":\"", type,
                     "\",\"rows\":", rows, ",\"columns\":", columns, ",\"offset\":", data_.size(),
                     more, "}");
  data_ += raw;
  data_.append((4 - data_.size() % 4) % 4, '\0');
}

void Bundle::add(std::string_view name, const MatX& values) {
  add_raw(name, "float32", values.rows(), values.cols(), raw(row_by_row<float>(values)));
}
void Bundle::add(std::string_view name, const Points& values) {
  add_raw(name, "float32", values.rows(), 3, raw(row_by_row<float>(values)));
}
void Bundle::add(std::string_view name, const Triangles& values) {
  add_raw(name, "uint32", values.rows(), 3, raw(row_by_row<std::uint32_t>(values)));
}
void Bundle::add(std::string_view name, std::span<const std::uint8_t> values) {
  add_raw(name, "uint8", static_cast<std::int64_t>(values.size()), 1,
          {reinterpret_cast<const char*>(values.data()), values.size()});
}
void Bundle::add(std::string_view name, std::span<const std::uint16_t> values) {
  add_raw(name, "uint16", static_cast<std::int64_t>(values.size()), 1,
          {reinterpret_cast<const char*>(values.data()), 2 * values.size()});
}

void Bundle::add_in_steps(std::string_view name, const MatX& values) {
  double low = kInfinity, high = -kInfinity;
  for (const double v : values.reshaped()) {
    if (v == v) low = std::min(low, v), high = std::max(high, v);
  }
  if (low > high) low = high = 0.0;
  const double step = high > low ? (high - low) / kSteps : 1.0, per_step = 1.0 / step;
  std::vector<std::uint16_t> q(static_cast<std::size_t>(values.size()));
  std::size_t at = 0;
  for (Eigen::Index r = 0; r < values.rows(); ++r) {
    for (Eigen::Index c = 0; c < values.cols(); ++c, ++at) {
      const double v = values(r, c);
      q[at] = v == v ? static_cast<std::uint16_t>((v - low) * per_step + 0.5) : kNoNumber;
    }
  }
  char more[80];
  std::snprintf(more, sizeof more, ",\"low\":%.9g,\"step\":%.9g", low, step);
  add_raw(name, "steps16", values.rows(), values.cols(), raw(q), more);
}

std::string Bundle::bytes() const {
  std::string header = join_text("{\"meta\":", meta_, ",\"arrays\":[", list_, "]}");
  header.append((4 - header.size() % 4) % 4, ' ');
  const auto length = static_cast<std::uint32_t>(header.size());
  std::string out = "CXB1";
  out.reserve(8 + header.size() + data_.size());
  out.append(reinterpret_cast<const char*>(&length), 4);
  out += header;
  out += data_;
  return out;
}

}  // namespace coxa::serve
