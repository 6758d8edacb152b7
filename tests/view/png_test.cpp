#include <coxa/view/png.h>

#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdlib>
#include <fstream>

namespace coxa::view {

// a decoder written from the specification, for one IDAT chunk and any filter
Image decoded(const std::vector<std::uint8_t>& file) {
  const auto number = [&](std::size_t i) {
    return file[i] << 24 | file[i + 1] << 16 | file[i + 2] << 8 | file[i + 3];
  };
  Image image(number(16), number(20));
  const std::size_t idat = 8 + 25;
  EXPECT_EQ(std::string(file.begin() + idat + 4, file.begin() + idat + 8), "IDAT");
  const std::size_t stride = static_cast<std::size_t>(image.width) * 3;
  std::vector<std::uint8_t> rows((stride + 1) * static_cast<std::size_t>(image.height));
  uLongf size = static_cast<uLongf>(rows.size());
  EXPECT_EQ(
      uncompress(rows.data(), &size, file.data() + idat + 8, static_cast<uLong>(number(idat))),
      Z_OK);
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    std::uint8_t* row = &rows[y * (stride + 1) + 1];
    EXPECT_EQ(row[-1], 4);
    for (std::size_t i = 0; i < stride; ++i) {
      const int a = i < 3 ? 0 : row[i - 3], b = y == 0 ? 0 : row[i - stride - 1],
                c = i < 3 || y == 0 ? 0 : row[i - stride - 4];
      const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
      row[i] = static_cast<std::uint8_t>(row[i] + (pa <= pb && pa <= pc ? a : pb <= pc ? b : c));
    }
    for (int x = 0; x < image.width; ++x)
      image.at(x, static_cast<int>(y)) = {row[3 * x], row[3 * x + 1], row[3 * x + 2]};
  }
  return image;
}

TEST(Png, DecodesToTheSamePixels) {
  Rng rng(1);
  Image image(37, 23);
  for (Colour& c : image.pixels)
    c = {static_cast<std::uint8_t>(rng.below(256)), static_cast<std::uint8_t>(rng.below(256)),
         static_cast<std::uint8_t>(rng.below(256))};
  EXPECT_EQ(decoded(encode_png(image)).pixels, image.pixels);
}
TEST(Png, ChunksCarryTheirChecksums) {
  const auto file = encode_png(Image(5, 4));
  const auto stored =
      static_cast<std::uint32_t>(file[29] << 24 | file[30] << 16 | file[31] << 8 | file[32]);
  EXPECT_EQ(stored, crc32(0, &file[12], 17));
  EXPECT_THROW(encode_png(Image()), Error);
}
TEST(Png, FailsWithBadFileWhereItCannotWrite) {
  try {
    write_png("/nowhere/at/all.png", Image(2, 2));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_file);
    EXPECT_NE(std::string(error.what()).find("/nowhere/at/all.png"), std::string::npos);
  }
}
TEST(Png, WritesAWholeFile) {
  const auto path = std::filesystem::temp_directory_path() / "coxa_view_png_test.png";
  write_png(path, Image(9, 9, kInk));
  std::ifstream file(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(bytes, encode_png(Image(9, 9, kInk)));
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".part"));
  std::filesystem::remove(path);
}
TEST(Base64, FollowsTheTestVectorsOfItsStandard) {
  const auto encoded = [](const std::string& text) { return base64({text.begin(), text.end()}); };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe\xfd"), "//79");
}

}  // namespace coxa::view
