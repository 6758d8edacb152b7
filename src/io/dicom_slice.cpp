#include "dicom_slice.h"

#include <coxa/core/error.h>

#include "dicom_outline.h"

#include <gdcmImageReader.h>
#include <gdcmReader.h>
#include <gdcmStringFilter.h>
#include <gdcmTrace.h>

#include <cstring>
#include <fstream>
#include <sstream>

namespace coxa::io {
namespace {

namespace fs = std::filesystem;

bool has_dicom_preamble(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::array<char, 132> head{};
  stream.read(head.data(), head.size());
  return stream.gcount() == 132 && std::memcmp(head.data() + 128, "DICM", 4) == 0;
}

/// Text of the header's elements, without padding.
class Header {
 public:
  Header(const gdcm::File& file, const fs::path& path) : path_(path) { filter_.SetFile(file); }

  std::string text(std::uint16_t group, std::uint16_t element) {
    std::string value = filter_.ToString(gdcm::Tag(group, element));
    while (!value.empty() && (value.back() == ' ' || value.back() == '\0')) value.pop_back();
    return value;
  }
  /// Numbers separated by backslashes.
  std::vector<double> numbers(std::uint16_t group, std::uint16_t element) {
    std::vector<double> values;
    std::istringstream stream(text(group, element));
    for (std::string part; std::getline(stream, part, '\\');) {
      std::istringstream number(part);
      double value = 0.0;
      if (number >> value) values.push_back(value);
    }
    return values;
  }
  std::vector<double> needed(std::uint16_t group, std::uint16_t element, std::size_t count,
                             const char* meaning) {
    std::vector<double> values = numbers(group, element);
    if (values.size() != count) {
      fail(ErrorCode::bad_file, path_.string(), ": the DICOM header lacks the ", meaning);
    }
    return values;
  }
  double number_or(std::uint16_t group, std::uint16_t element, double otherwise) {
    const std::vector<double> values = numbers(group, element);
    return values.empty() ? otherwise : values[0];
  }

 private:
  gdcm::StringFilter filter_;
  const fs::path& path_;
};

Vec3 unit_axis(const std::vector<double>& v, std::size_t begin) {
  return Vec3(v[begin], v[begin + 1], v[begin + 2]).normalized();
}

/// False too where the decoder throws.
template <class F>
bool succeeds(const F& decode) {
  try {
    return decode();
  } catch (const std::exception&) {
    return false;
  }
}

template <class T>
void convert(const std::vector<char>& raw, double slope, double intercept,
             std::vector<float>& values) {
  const T* typed = reinterpret_cast<const T*>(raw.data());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(slope * static_cast<double>(typed[i]) + intercept);
  }
}

}  // namespace

std::optional<DicomSlice> read_dicom_header(const fs::path& file) {
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  if (!has_dicom_preamble(file)) return std::nullopt;
  const DicomOutline outline = outline_dicom(file);
  if (!outline.header_whole) {
    fail(ErrorCode::bad_file, file.string(), " ", outline.fault,
         "; copy it again or take it out of the folder");
  }
  if (!outline.has_image) return std::nullopt;
  gdcm::Reader reader;
  reader.SetFileName(file.c_str());
  if (!succeeds([&] { return reader.ReadUpToTag(gdcm::Tag(0x7fe0, 0x0010)); })) {
    fail(ErrorCode::bad_file, file.string(),
         " is a broken DICOM file: its header cannot be read; copy it again or take it out of the "
         "folder");
  }
  Header header(reader.GetFile(), file);
  DicomSlice slice;
  slice.rows = static_cast<int>(header.number_or(0x0028, 0x0010, 0.0));
  slice.columns = static_cast<int>(header.number_or(0x0028, 0x0011, 0.0));
  if (slice.rows <= 0 || slice.columns <= 0) return std::nullopt;

  slice.file = file;
  slice.series_uid = header.text(0x0020, 0x000e);
  slice.series_number = header.text(0x0020, 0x0011);
  slice.description = header.text(0x0008, 0x103e);
  slice.modality = header.text(0x0008, 0x0060);
  slice.echo = header.text(0x0018, 0x0086);
  slice.image_type = header.text(0x0008, 0x0008);
  slice.instance = static_cast<int>(header.number_or(0x0020, 0x0013, 0.0));
  slice.frames = static_cast<int>(header.number_or(0x0028, 0x0008, 1.0));
  slice.thickness = header.number_or(0x0018, 0x0050, kNaN);
  slice.fault = outline.fault;
  if (slice.frames > 1) return slice;  // its places are per frame; the series will be refused

  const std::vector<double> place = header.needed(0x0020, 0x0032, 3, "image position");
  const std::vector<double> axes = header.needed(0x0020, 0x0037, 6, "image orientation");
  const std::vector<double> spacing = header.needed(0x0028, 0x0030, 2, "pixel spacing");
  slice.position = Vec3(place[0], place[1], place[2]);
  slice.row_axis = unit_axis(axes, 0);
  slice.column_axis = unit_axis(axes, 3);
  slice.row_spacing = spacing[0];
  slice.column_spacing = spacing[1];
  return slice;
}

std::vector<float> read_dicom_pixels(const fs::path& file, int columns, int rows) {
  gdcm::ImageReader reader;
  reader.SetFileName(file.c_str());
  if (!succeeds([&] { return reader.Read(); }))
    fail(ErrorCode::bad_file, file.string(), ": the pixels cannot be decoded");
  const gdcm::Image& image = reader.GetImage();
  const gdcm::PixelFormat format = image.GetPixelFormat();
  require(format.GetSamplesPerPixel() == 1, file.string(),
          " is a colour image; a scalar one is needed");
  std::vector<char> raw(image.GetBufferLength());
  std::vector<float> values(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  if (!succeeds([&] { return image.GetBuffer(raw.data()); }) ||
      raw.size() != values.size() * format.GetPixelSize()) {
    fail(ErrorCode::bad_file, file.string(), ": the pixels are incomplete");
  }
  const double slope = image.GetSlope(), intercept = image.GetIntercept();
  switch (format.GetScalarType()) {
    case gdcm::PixelFormat::UINT8:
      convert<std::uint8_t>(raw, slope, intercept, values);
      break;
    case gdcm::PixelFormat::INT8:
      convert<std::int8_t>(raw, slope, intercept, values);
      break;
    case gdcm::PixelFormat::UINT16:
      convert<std::uint16_t>(raw, slope, intercept, values);
      break;
    case gdcm::PixelFormat::INT16:
      convert<std::int16_t>(raw, slope, intercept, values);
      break;
    case gdcm::PixelFormat::UINT32:
      convert<std::uint32_t>(raw, slope, intercept, values);
      break;
    case gdcm::PixelFormat::INT32:
      convert<std::int32_t>(raw, slope, intercept, values);
      break;
    case gdcm::PixelFormat::FLOAT32:
      convert<float>(raw, slope, intercept, values);
      break;
    case gdcm::PixelFormat::FLOAT64:
      convert<double>(raw, slope, intercept, values);
      break;
    default:
      fail(ErrorCode::bad_input, file.string(), " stores pixels as ",
           format.GetScalarTypeAsString(), ", which is not supported");
  }
  return values;
}

}  // namespace coxa::io
