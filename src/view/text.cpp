#include <coxa/view/image.h>

#include <algorithm>
#include <cmath>

namespace coxa::view {
namespace {

struct Glyph {
  int code, advance, width, height, left, top;
  const char* levels;  // width*height hexadecimal digits
};

constexpr double kDesignSize = 24.0;
const Glyph kGlyphs[] = {
#include "font_data.inc"
};

const Glyph& glyph_of(char32_t code) {
  for (const Glyph& glyph : kGlyphs)
    if (static_cast<char32_t>(glyph.code) == code) return glyph;
  return glyph_of(U'?');
}

// next code point of UTF-8 text, moving `place` past it; broken sequences give '?'
char32_t next_code(std::string_view text, std::size_t& place) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const unsigned first = byte(place);
  const std::size_t length = first < 0x80       ? 1
                             : first >> 5 == 6  ? 2
                             : first >> 4 == 14 ? 3
                             : first >> 3 == 30 ? 4
                                                : 0;
  if (length == 0) {
    ++place;
    return U'?';
  }
  char32_t code = length == 1 ? first : first & (0x7f >> length);
  for (std::size_t i = 1; i < length; ++i) code = (code << 6) | (byte(place + i) & 0x3f);
  place += length;
  return code;
}

double level(const Glyph& glyph, int x, int y) {
  if (x < 0 || y < 0 || x >= glyph.width || y >= glyph.height) return 0.0;
  const char c = glyph.levels[y * glyph.width + x];
  return (c <= '9' ? c - '0' : c - 'a' + 10) / 15.0;
}

// mean ink of the glyph over the square [x, x + step] × [y, y + step] of its design pixels
double coverage(const Glyph& glyph, double x, double y, double step) {
  double sum = 0.0;
  for (int row = static_cast<int>(std::floor(y)); row < y + step; ++row)
    for (int column = static_cast<int>(std::floor(x)); column < x + step; ++column) {
      const double wide =
          std::min(x + step, column + 1.0) - std::max(x, static_cast<double>(column));
      const double high = std::min(y + step, row + 1.0) - std::max(y, static_cast<double>(row));
      sum += wide * high * level(glyph, column, row);
    }
  return sum / (step * step);
}

void update_glyph(Image& image, const Glyph& glyph, double x, double y, Colour colour,
                  double step) {
  const double left = x + glyph.left / step, top = y + glyph.top / step;
  for (int row = static_cast<int>(std::floor(top)); row < top + glyph.height / step; ++row)
    for (int column = static_cast<int>(std::floor(left)); column < left + glyph.width / step;
         ++column) {
      if (!image.holds(column, row)) continue;
      const double ink = coverage(glyph, (column - left) * step, (row - top) * step, step);
      if (ink > 0.0) image.at(column, row) = mixed(image.at(column, row), colour, ink);
    }
}

}  // namespace

void update_text(Image& image, double x, double y, std::string_view text, Colour colour,
                 double size) {
  const double step = kDesignSize / size;  // design pixels per picture pixel
  for (std::size_t place = 0; place < text.size();) {
    const Glyph& glyph = glyph_of(next_code(text, place));
    update_glyph(image, glyph, x, y, colour, step);
    x += glyph.advance / step;
  }
}

double text_width(std::string_view text, double size) {
  double width = 0.0;
  for (std::size_t place = 0; place < text.size();)
    width += glyph_of(next_code(text, place)).advance * size / kDesignSize;
  return width;
}

double line_height(double size) { return 1.25 * size; }

}  // namespace coxa::view
