#include "panel.h"

#include <coxa/view/colour_map.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa::view {
namespace {

// an oblique direction gets a second letter when that share of it is at least this
constexpr double kSecondLetter = 0.4;

}  // namespace

std::string direction_letters(const Vec3& direction) {
  static constexpr std::array<std::array<char, 2>, 3> kLetters{
      {{'R', 'L'}, {'A', 'P'}, {'I', 'S'}}};
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(),
                   [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  std::string letters;
  for (int axis : axes)
    if (letters.size() < 2 &&
        std::abs(direction[axis]) > kSecondLetter * std::abs(direction[axes[0]]))
      letters += kLetters[static_cast<std::size_t>(axis)][direction[axis] > 0.0 ? 1 : 0];
  return letters;
}

void update_side_letters(Image& image, const Vec3& right, const Vec3& up, Colour colour) {
  const double w = image.width, h = image.height, edge = 5.0;
  const auto letter_width = [](const std::string& letter) { return text_width(letter, kTextSize); };
  const std::string to_right = direction_letters(right), to_left = direction_letters(-right);
  const std::string to_top = direction_letters(up), to_bottom = direction_letters(-up);
  update_text(image, w - edge - letter_width(to_right), 0.5 * h - 0.6 * kTextSize, to_right, colour,
              kTextSize);
  update_text(image, edge, 0.5 * h - 0.6 * kTextSize, to_left, colour, kTextSize);
  update_text(image, 0.5 * (w - letter_width(to_top)), 2.0, to_top, colour, kTextSize);
  update_text(image, 0.5 * (w - letter_width(to_bottom)), h - line_height(kTextSize) - 1.0,
              to_bottom, colour, kTextSize);
}

void update_scale_bar(Image& image, double mm_per_pixel, Colour colour) {
  const double longest = 0.3 * image.width * mm_per_pixel;
  double length = 1.0;
  for (double candidate : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0})
    if (candidate <= longest) length = candidate;
  const double y = image.height - 8.0, x = 10.0;
  update_line(image, Vec2(x, y), Vec2(x + length / mm_per_pixel, y), colour, 2.0);
  update_text(image, x, y - line_height(kTextSize) - 3.0, tick_label(length, 1.0) + " mm", colour,
              kTextSize);
}

Image draw_legend(const std::vector<std::string>& names, int width) {
  const double row_height = line_height(kTextSize) + 4.0, box = 12.0;
  struct Entry {
    double x;
    int row;
  };
  std::vector<Entry> entries;
  double x = 4.0;
  int row = 0;
  for (const std::string& name : names) {
    const double needed = box + 6.0 + text_width(readable(name), kTextSize) + 18.0;
    if (x > 4.0 && x + needed > width) {
      x = 4.0;
      ++row;
    }
    entries.push_back({x, row});
    x += needed;
  }
  Image legend(width, names.empty() ? 0 : static_cast<int>(std::ceil((row + 1) * row_height)) + 4);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double y = 4.0 + entries[i].row * row_height;
    update_fill(legend, static_cast<int>(entries[i].x), static_cast<int>(y + 2),
                static_cast<int>(box), static_cast<int>(box), structure_colour(names[i]));
    update_text(legend, entries[i].x + box + 6.0, y - 1.0, readable(names[i]), kInk, kTextSize);
  }
  return legend;
}

Image titled(const Image& image, const std::string& title) {
  const int margin = static_cast<int>(std::ceil(line_height(kTextSize))) + 4;
  // a long title gets smaller letters rather than being cut
  const double size = std::min(
      kTextSize, kTextSize * (image.width - 4.0) / std::max(1.0, text_width(title, kTextSize)));
  Image result(image.width, image.height + margin);
  update_text(result, 2.0, 1.0, title, kInk, size);
  update_paste(result, image, 0, margin);
  return result;
}

}  // namespace coxa::view
