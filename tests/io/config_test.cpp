#include <coxa/io/config.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace coxa::io {
namespace fs = std::filesystem;

class Config : public ::testing::Test {
 protected:
  Config()
      : path_(fs::temp_directory_path() / ("coxa_config_" + std::to_string(getpid()) + ".toml")) {}
  ~Config() override { fs::remove(path_); }
  Table parse(const std::string& text) {
    write_bytes(path_, text);
    return Table::read(path_);
  }
  static std::string error_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  fs::path path_;
};

TEST_F(Config, GivesValuesOfEveryKind) {
  const Table t = parse(
      "a = true\nb = 3\nc = 2.5\nd = \"x\"\ne = [1, 2.5, 3]\nf = [\"p\", \"q\"]\n[g]\nh = 1\n");
  EXPECT_TRUE(t.get<bool>("a"));
  EXPECT_EQ(t.get<Index>("b"), 3);
  EXPECT_DOUBLE_EQ(t.get<double>("b"), 3.0);
  EXPECT_DOUBLE_EQ(t.get<double>("c"), 2.5);
  EXPECT_EQ(t.get<std::string>("d"), "x");
  EXPECT_EQ(t.get<Vec3>("e"), Vec3(1, 2.5, 3));
  EXPECT_EQ(t.get<std::vector<std::string>>("f"), (std::vector<std::string>{"p", "q"}));
  EXPECT_EQ(t.find_table("g")->get<Index>("h"), 1);
  t.finish();
}
TEST_F(Config, NamesTheNearestKnownKeyAndTheLineOfAMisspeltOne) {
  const Table t = parse("side = \"left\"\nlandmrks = \"x\"\n");
  t.get<std::string>("side");
  t.find<std::string>("landmarks");
  const std::string text = error_of([&] { t.finish(); });
  EXPECT_NE(text.find(":2: landmrks is not a known key; did you mean landmarks?"),
            std::string::npos)
      << text;
}
TEST_F(Config, SaysWhatIsMissingOrOfAnotherType) {
  const Table t = parse("force_N = \"many\"\n");
  EXPECT_NE(error_of([&] { t.get<double>("force_N"); }).find(":1: force_N must be a number"),
            std::string::npos);
  EXPECT_NE(error_of([&] { t.get<std::string>("side"); }).find("needs the key side"),
            std::string::npos);
}
TEST_F(Config, SaysWhereTheFileIsNotToml) {
  EXPECT_NE(error_of([&] { parse("a = 1\nb = = 2\n"); }).find(".toml:2:"), std::string::npos);
}
TEST_F(Config, ResolvesPathsAgainstItsFolder) {
  const Table t = parse("image = \"scan/t1.nii.gz\"\n");
  EXPECT_EQ(*t.find_path("image"), (path_.parent_path() / "scan/t1.nii.gz").lexically_normal());
}
TEST_F(Config, TakesASingleTableForAListOfOne) {
  EXPECT_EQ(parse("[[image]]\npath = \"a\"\n[[image]]\npath = \"b\"\n").tables("image").size(), 2U);
  EXPECT_EQ(parse("[image]\npath = \"a\"\n").tables("image").size(), 1U);
}

TEST(NearestWord, IsNoneWhenNothingIsNear) {
  EXPECT_EQ(nearest_word("frames", {"side", "image"}), std::nullopt);
  EXPECT_EQ(nearest_word("fram", {"side", "frames"}), "frames");
}

}  // namespace coxa::io
