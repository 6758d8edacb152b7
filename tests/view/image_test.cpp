#include <coxa/view/image.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include <array>

namespace coxa::view {

int dark_pixels(const Image& image) {
  int n = 0;
  for (const Colour& c : image.pixels) n += c.r < 128;
  return n;
}

TEST(Image, PasteCutsOffWhatSticksOut) {
  Image image(4, 3);
  update_paste(image, Image(3, 3, kBlack), -1, 1);
  EXPECT_EQ(dark_pixels(image), 4);
  EXPECT_EQ(image.at(0, 1), kBlack);
  EXPECT_EQ(image.at(2, 1), kWhite);
}
TEST(Image, LineCoversAsManyPixelsAsItsArea) {
  Image image(100, 50);
  update_line(image, Vec2(10, 20), Vec2(90, 20), kBlack, 4.0);
  EXPECT_NEAR(dark_pixels(image), 80 * 4, 16);
  EXPECT_EQ(image.at(50, 20), kBlack);
  EXPECT_EQ(image.at(50, 25), kWhite);
  update_line(image, Vec2(-1e6, 5), Vec2(1e6, 5), kBlack);  // clipped, not endless
  EXPECT_LT(image.at(99, 4).r, 200);
}
TEST(Image, TextIsAsWideAsItSaysAtEverySize) {
  for (double size : {10.0, 14.0, 24.0, 40.0}) {
    Image image(400, 80);
    update_text(image, 10, 10, "H°H", kBlack, size);
    int right = 0, left = 1000;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        if (image.at(x, y).r < 200) {
          right = std::max(right, x);
          left = std::min(left, x);
        }
    EXPECT_NEAR(right - left, text_width("H°H", size) - 0.2 * size, 0.1 * size + 1);
  }
}
TEST(Image, CharactersTheFontLacksShowAsQuestionMarks) {
  EXPECT_EQ(text_width("\xe4\xb8\xad"), text_width("?"));
  EXPECT_EQ(text_width("\xff"), text_width("?"));
  EXPECT_EQ(text_width("µ"), text_width("\xc2\xb5"));
  EXPECT_EQ(text_width(""), 0.0);
}
TEST(Image, RowsAndColumnsAddUp) {
  const std::array images{Image(10, 20), Image(30, 5)};
  EXPECT_EQ(beside(images, 4).width, 44);
  EXPECT_EQ(beside(images, 4).height, 20);
  EXPECT_EQ(below(images, 4).width, 30);
  EXPECT_EQ(below(images, 4).height, 29);
}
TEST(Image, MixesColoursByShare) {
  EXPECT_EQ(mixed(kBlack, kWhite, 0.5), (Colour{128, 128, 128}));
  EXPECT_EQ(mixed(kBlack, kWhite, 0.0), kBlack);
  EXPECT_THROW(Image(-1, 5), Error);
}

}  // namespace coxa::view
