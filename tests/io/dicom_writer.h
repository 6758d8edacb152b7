#pragma once

#include <coxa/core/types.h>
#include <coxa/io/files.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace coxa::io {

/// What one DICOM slice of a test says.
struct TestSlice {
  std::string series_uid = "1.2.3.4", series_number = "3", description = "t1 axial";
  std::string echo = "1";
  Vec3 position = Vec3::Zero(), row = Vec3::UnitX(), column = Vec3::UnitY();
  double column_spacing = 0.5, row_spacing = 0.75;
  std::optional<double> thickness = 4.0;
  int columns = 3, rows = 2, frames = 1;
  int samples_per_pixel = 1;
  std::vector<std::int16_t> pixels = {1, 2, 3, 4, 5, 6};
  double slope = 1.0;
  bool has_pixels = true;  ///< false: an object such as an RTSTRUCT
};

/// DICOM data elements in explicit little-endian encoding, appended in ascending order of tags.
class DicomElements {
 public:
  void text(std::uint16_t group, std::uint16_t element, const char* vr, std::string value) {
    if (value.size() % 2 == 1) value.push_back(std::string(vr) == "UI" ? '\0' : ' ');
    begin(group, element, vr);
    number(static_cast<std::uint16_t>(value.size()));
    bytes_ += value;
  }
  void integer(std::uint16_t group, std::uint16_t element, int value) {
    begin(group, element, "US");
    number(std::uint16_t{2});
    number(static_cast<std::uint16_t>(value));
  }
  void pixels(const std::vector<std::int16_t>& values) {
    begin(0x7fe0, 0x0010, "OW");
    number(std::uint16_t{0});
    number(static_cast<std::uint32_t>(2 * values.size()));
    for (const std::int16_t value : values) number(value);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void begin(std::uint16_t group, std::uint16_t element, const char* vr) {
    number(group);
    number(element);
    bytes_ += vr;
  }
  template <class T>
  void number(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  std::string bytes_;
};

inline std::string backslashed(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : "\\") + std::to_string(value);
  return text;
}

inline std::string dicom_bytes(const TestSlice& slice) {
  const std::string sop =
      slice.has_pixels ? "1.2.840.10008.5.1.4.1.1.4" : "1.2.840.10008.5.1.4.1.1.481.3";
  DicomElements meta;
  meta.text(2, 2, "UI", sop);
  meta.text(2, 3, "UI", "1.2.3");
  meta.text(2, 0x10, "UI", "1.2.840.10008.1.2.1");
  DicomElements data;
  data.text(8, 0x16, "UI", sop);
  data.text(8, 0x18, "UI", "1.2.3");
  data.text(8, 0x60, "CS", slice.has_pixels ? "MR" : "RTSTRUCT");
  data.text(8, 0x103e, "LO", slice.description);
  if (slice.thickness) data.text(0x18, 0x50, "DS", std::to_string(*slice.thickness));
  data.text(0x18, 0x86, "IS", slice.echo);
  data.text(0x20, 0x0e, "UI", slice.series_uid);
  data.text(0x20, 0x11, "IS", slice.series_number);
  if (slice.has_pixels) {
    const auto list = [](const Vec3& v) { return std::vector<double>{v[0], v[1], v[2]}; };
    data.text(0x20, 0x32, "DS", backslashed(list(slice.position)));
    data.text(0x20, 0x37, "DS",
              backslashed(list(slice.row)) + "\\" + backslashed(list(slice.column)));
    data.integer(0x28, 2, slice.samples_per_pixel);
    data.text(0x28, 4, "CS", slice.samples_per_pixel == 1 ? "MONOCHROME2" : "RGB");
    if (slice.samples_per_pixel > 1) data.integer(0x28, 6, 0);
    if (slice.frames > 1) data.text(0x28, 8, "IS", std::to_string(slice.frames));
    data.integer(0x28, 0x10, slice.rows);
    data.integer(0x28, 0x11, slice.columns);
    data.text(0x28, 0x30, "DS", backslashed({slice.row_spacing, slice.column_spacing}));
    const int bits = slice.samples_per_pixel == 1 ? 16 : 8;
    data.integer(0x28, 0x100, bits);
    data.integer(0x28, 0x101, bits);
    data.integer(0x28, 0x102, bits - 1);
    data.integer(0x28, 0x103, slice.samples_per_pixel == 1 ? 1 : 0);
    data.text(0x28, 0x1052, "DS", "0");
    data.text(0x28, 0x1053, "DS", std::to_string(slice.slope));
    data.pixels(slice.pixels);
  }
  // the length of the meta group comes first
  std::string head(128, '\0');
  head += "DICM";
  const std::uint16_t tag[2] = {2, 0}, four = 4;
  const auto size = static_cast<std::uint32_t>(meta.bytes().size());
  head.append(reinterpret_cast<const char*>(tag), 4);
  head += "UL";
  head.append(reinterpret_cast<const char*>(&four), 2);
  head.append(reinterpret_cast<const char*>(&size), 4);
  return head + meta.bytes() + data.bytes();
}

inline void write_dicom(const std::filesystem::path& path, const TestSlice& slice) {
  write_bytes(path, dicom_bytes(slice));
}

}  // namespace coxa::io
