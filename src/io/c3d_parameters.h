#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace coxa::io {

/// Who wrote the numbers of a C3D file.
enum class C3dProcessor { intel = 84, dec = 85, sgi = 86 };

/// Numbers of a C3D file in its processor's format, with every access checked against the file's
/// end.
class C3dBytes {
 public:
  C3dBytes(std::vector<unsigned char> bytes, std::string name)
      : bytes_(std::move(bytes)), name_(std::move(name)) {}
  void set_processor(C3dProcessor processor) { processor_ = processor; }
  C3dProcessor processor() const { return processor_; }

  std::size_t size() const { return bytes_.size(); }
  const std::string& name() const { return name_; }
  std::uint8_t byte(std::size_t at) const;
  std::uint16_t word(std::size_t at) const;
  std::int16_t integer(std::size_t at) const { return static_cast<std::int16_t>(word(at)); }
  double real(std::size_t at) const;
  std::string text(std::size_t at, std::size_t length) const;

 private:
  void check(std::size_t at, std::size_t length) const;
  std::vector<unsigned char> bytes_;
  std::string name_;
  C3dProcessor processor_ = C3dProcessor::intel;
};

/// One parameter: numbers or texts, with its sizes.
struct C3dParameter {
  std::vector<int> sizes;          ///< empty for a scalar
  std::vector<double> numbers;     ///< of bytes, integers and reals
  std::vector<std::string> texts;  ///< of characters, trailing blanks removed
  bool is_text = false;
};

/// "GROUP:NAME" in capitals -> parameter.
using C3dParameters = std::map<std::string, C3dParameter>;

/// Reads the parameter section in bytes [start, limit); a broken section is read as far as it makes
/// sense, and what was wrong is added to `warnings`.
C3dParameters read_c3d_parameters(const C3dBytes& file, std::size_t start, std::size_t limit,
                                  std::vector<std::string>& warnings);

}  // namespace coxa::io
