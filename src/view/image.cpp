#include <coxa/view/image.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <cmath>

namespace coxa::view {

Colour mixed(Colour a, Colour b, double share) {
  const auto channel = [share](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + share * (to - from)));
  };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

Image::Image(int w, int h, Colour fill) : width(w), height(h) {
  require(w >= 0 && h >= 0 && static_cast<std::int64_t>(w) * h < (std::int64_t{1} << 30),
          "picture of ", w, " x ", h, " pixels");
  pixels.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill);
}

void update_paste(Image& image, const Image& part, int x, int y) {
  for (int row = std::max(0, -y); row < part.height && y + row < image.height; ++row)
    for (int column = std::max(0, -x); column < part.width && x + column < image.width; ++column)
      image.at(x + column, y + row) = part.at(column, row);
}

void update_fill(Image& image, int x, int y, int width, int height, Colour colour) {
  for (int row = std::max(0, y); row < std::min(image.height, y + height); ++row)
    for (int column = std::max(0, x); column < std::min(image.width, x + width); ++column)
      image.at(column, row) = colour;
}

void update_line(Image& image, const Vec2& from, const Vec2& to, Colour colour, double thickness) {
  const Vec2 along = to - from;
  const double reach = 0.5 * thickness + 1.0, squared = along.squaredNorm();
  const Vec2 low = from.cwiseMin(to).array() - reach, high = from.cwiseMax(to).array() + reach;
  const auto pixel = [](double v, int size) {
    return static_cast<int>(std::floor(std::clamp(v, -1.0, static_cast<double>(size))));
  };
  for (int y = std::max(0, pixel(low[1], image.height));
       y <= std::min(image.height - 1, pixel(high[1], image.height)); ++y)
    for (int x = std::max(0, pixel(low[0], image.width));
         x <= std::min(image.width - 1, pixel(high[0], image.width)); ++x) {
      const Vec2 offset = Vec2(x + 0.5, y + 0.5) - from;
      const double s = squared > 0.0 ? std::clamp(offset.dot(along) / squared, 0.0, 1.0) : 0.0;
      const double cover =
          std::clamp(0.5 * thickness + 0.5 - (offset - s * along).norm(), 0.0, 1.0);
      if (cover > 0.0) image.at(x, y) = mixed(image.at(x, y), colour, cover);
    }
}

Image beside(std::span<const Image> images, int gap, Colour background) {
  int width = 0, height = 0;
  for (const Image& image : images) {
    width += image.width + (width > 0 ? gap : 0);
    height = std::max(height, image.height);
  }
  Image row(width, height, background);
  int x = 0;
  for (const Image& image : images) {
    update_paste(row, image, x, 0);
    x += image.width + gap;
  }
  return row;
}

Image below(std::span<const Image> images, int gap, Colour background) {
  int width = 0, height = 0;
  for (const Image& image : images) {
    height += image.height + (height > 0 ? gap : 0);
    width = std::max(width, image.width);
  }
  Image column(width, height, background);
  int y = 0;
  for (const Image& image : images) {
    update_paste(column, image, 0, y);
    y += image.height + gap;
  }
  return column;
}

}  // namespace coxa::view
