#include <coxa/serve/guard.h>

#include <coxa/io/files.h>
#include <gtest/gtest.h>

#include "serve/client.h"

namespace coxa::serve {
namespace {

TEST(Refusal, LetsInThisMachinesOwnNamesAlone) {
  for (const char* host : {"localhost", "localhost:8080", "127.0.0.1:1", "[::1]", "[::1]:8080"})
    EXPECT_EQ(refusal({host, "", "", ""}, ""), "") << host;
  for (const char* host : {"evil.example", "127.0.0.1.evil.example", "localhost.evil", "", "[::2]"})
    EXPECT_NE(refusal({host, "", "", ""}, ""), "") << host;
}
TEST(Refusal, RefusesPagesOfOtherOrigins) {
  EXPECT_EQ(refusal({"localhost:80", "http://localhost:80", "", ""}, ""), "");
  EXPECT_NE(refusal({"localhost:80", "http://localhost:81", "", ""}, ""), "");
  EXPECT_NE(refusal({"localhost:80", "null", "", ""}, ""), "");
}
TEST(Refusal, AsksForTheTokenInCookieOrQuery) {
  EXPECT_EQ(refusal({"10.0.0.1", "", "a=b; coxa_token=secret", ""}, "secret"), "");
  EXPECT_EQ(refusal({"10.0.0.1", "", "", "x=1&token=secret"}, "secret"), "");
  EXPECT_NE(refusal({"10.0.0.1", "", "", ""}, "secret"), "");
  EXPECT_NE(refusal({"10.0.0.1", "", "coxa_token=secre", "token=secretx"}, "secret"), "");
  EXPECT_NE(refusal({"localhost", "", "xcoxa_token=secret", ""}, "secret"), "");
}
TEST(PercentDecoded, RefusesBrokenEscapesAndZeroBytes) {
  EXPECT_EQ(percent_decoded("/a%20b"), "/a b");
  for (const char* text : {"%", "%2", "%zz", "a%00b"}) EXPECT_FALSE(percent_decoded(text)) << text;
}
TEST(QueryValue, FindsItsKey) {
  EXPECT_EQ(query_value("a=1&name=x%2Fy&b", "name"), "x/y");
  EXPECT_EQ(query_value("ab=1", "b"), "");
}

class FileInside : public ::testing::Test {
 protected:
  test::TempFolder folder{"coxa_inside"};
  std::filesystem::path root = folder.path / "root";
  void SetUp() override {
    io::write_bytes(root / "sub/a.txt", "a");
    io::write_bytes(folder.path / "secret.txt", "s");
    io::write_bytes(folder.path / "root_beside/b.txt", "b");
  }
};
TEST_F(FileInside, FindsWhatIsInside) {
  EXPECT_TRUE(file_inside(root, "sub/a.txt"));
  EXPECT_TRUE(file_inside(root, "/sub/../sub/a.txt"));
}
TEST_F(FileInside, FindsNothingOutside) {
  for (const char* path : {"../secret.txt", "sub/../../secret.txt", "../root_beside/b.txt",
                           "/etc/passwd", "//etc/passwd", "sub", "", "no.txt"})
    EXPECT_FALSE(file_inside(root, path)) << path;
}
TEST_F(FileInside, DoesNotFollowALinkOut) {
  std::filesystem::create_symlink(folder.path / "secret.txt", root / "link.txt");
  EXPECT_FALSE(file_inside(root, "link.txt"));
}
TEST(MakeToken, GivesAnotherEachTime) {
  EXPECT_EQ(make_token().size(), 32u);
  EXPECT_NE(make_token(), make_token());
}

}  // namespace
}  // namespace coxa::serve
