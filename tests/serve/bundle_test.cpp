#include <coxa/serve/bundle.h>

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

namespace coxa::serve {
namespace {

TEST(Bundle, HoldsWhatWasPutIntoItOnFourByteBounds) {
  Bundle bundle(R"({"frame":3})");
  const std::vector<std::uint8_t> tags{1, 2, 3};
  bundle.add("tags", tags);
  MatX values(2, 2);
  values << 1.5, 2.5, 3.5, 4.5;
  bundle.add("values", values);
  Triangles triangles(1, 3);
  triangles << 7, 8, 9;
  bundle.add("triangles", triangles);

  const std::string bytes = bundle.bytes();
  ASSERT_EQ(bytes.substr(0, 4), "CXB1");
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 4, 4);
  EXPECT_EQ(length % 4, 0u);
  const auto header = nlohmann::json::parse(bytes.substr(8, length));
  EXPECT_EQ(header["meta"]["frame"], 3);
  const auto array_at = [&](int i) {
    return bytes.data() + 8 + length + header["arrays"][i]["offset"].get<std::size_t>();
  };
  EXPECT_EQ(array_at(0)[2], 3);
  float row[4];
  std::memcpy(row, array_at(1), sizeof row);
  EXPECT_EQ(row[1], 2.5f);  // row by row, whatever the matrix' own order
  EXPECT_EQ(header["arrays"][1]["offset"].get<int>() % 4, 0);
  std::uint32_t corner = 0;
  std::memcpy(&corner, array_at(2) + 8, 4);
  EXPECT_EQ(corner, 9u);
}

TEST(Bundle, HoldsNumbersInStepsOfTheirRange) {
  MatX values(3, 2);
  values << -3.0, 5.0, 1.25, kNaN, 0.0, 4.999;
  Bundle bundle;
  bundle.add_in_steps("values", values);
  const std::string bytes = bundle.bytes();
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 4, 4);
  const auto entry = nlohmann::json::parse(bytes.substr(8, length))["arrays"][0];
  EXPECT_EQ(entry["type"], "steps16");
  for (int i = 0; i < 6; ++i) {
    std::uint16_t q = 0;
    std::memcpy(&q, bytes.data() + 8 + length + 2 * i, 2);
    const double wanted = values(i / 2, i % 2);
    if (wanted != wanted) {
      EXPECT_EQ(q, 65535);
    } else {
      EXPECT_NEAR(entry["low"].get<double>() + q * entry["step"].get<double>(), wanted,
                  8.0 / 131000);
    }
  }
  Bundle flat;
  flat.add_in_steps("none", MatX::Constant(2, 1, kNaN));
  EXPECT_EQ(flat.bytes().substr(0, 4), "CXB1");
}

}  // namespace
}  // namespace coxa::serve
