#pragma once

#include <coxa/core/types.h>

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace coxa::view {

/// sRGB colour, 0 to 255.
struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Colour&) const = default;
};
inline constexpr Colour kBlack{0, 0, 0};
inline constexpr Colour kWhite{255, 255, 255};
inline constexpr Colour kInk{38, 38, 38};

/// `share` of b mixed into a.
Colour mixed(Colour a, Colour b, double share);

/// Picture in memory; rows from the top, pixel (0, 0) top left.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Colour> pixels;  ///< width*height

  Image() = default;
  Image(int w, int h, Colour fill = kWhite);
  Colour& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  Colour at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  bool holds(int x, int y) const { return 0 <= x && x < width && 0 <= y && y < height; }
};

/// Copies `part` with its top left corner at (x, y); what sticks out is cut off.
void update_paste(Image& image, const Image& part, int x, int y);
void update_fill(Image& image, int x, int y, int width, int height, Colour colour);
/// Straight line with soft edges, `thickness` pixels wide; coordinates in pixels, (0.5, 0.5) is the
/// first pixel's middle.
void update_line(Image& image, const Vec2& from, const Vec2& to, Colour colour,
                 double thickness = 1.0);

/// Text in DejaVu Sans, its top left corner at (x, y), `size` pixels to the em. Characters the font
/// lacks show as '?'.
void update_text(Image& image, double x, double y, std::string_view text, Colour colour,
                 double size = 14.0);
/// Width of that text in pixels.
double text_width(std::string_view text, double size = 14.0);
/// Height of a line of text in pixels.
double line_height(double size = 14.0);

/// Pictures in a row (tops aligned) or in a column (left sides aligned), `gap` pixels apart.
Image beside(std::span<const Image> images, int gap = 8, Colour background = kWhite);
Image below(std::span<const Image> images, int gap = 8, Colour background = kWhite);

}  // namespace coxa::view
