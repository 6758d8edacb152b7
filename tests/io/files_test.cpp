#include <coxa/io/files.h>

#include "io/test_files.h"

#include <csignal>
#include <string>

#include <sys/resource.h>

namespace coxa::io {
namespace {

TEST(Files, HashesAreThoseOfTheStandard) {
  EXPECT_EQ(sha256_of_bytes(""),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_of_bytes("abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of_bytes("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_of_bytes(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}
TEST(Files, HashOfAFolderChangesWithContentAndNames) {
  const TestFolder folder;
  write_bytes(folder / "in/a.txt", "1");
  write_bytes(folder / "in/deep/b.txt", "2");
  const std::string before = sha256_of_path(folder / "in");
  EXPECT_EQ(sha256_of_path(folder / "in"), before);
  write_bytes(folder / "in/a.txt", "3");
  EXPECT_NE(sha256_of_path(folder / "in"), before);
  write_bytes(folder / "in/a.txt", "1");
  std::filesystem::rename(folder / "in/deep/b.txt", folder / "in/deep/c.txt");
  EXPECT_NE(sha256_of_path(folder / "in"), before);
}
TEST(Files, BytesComeBackAndNothingElseIsLeft) {
  const TestFolder folder;
  const std::string bytes("a\0b\n\xff", 5);
  write_bytes(folder / "new/folder/a.bin", bytes);
  EXPECT_EQ(read_bytes(folder / "new/folder/a.bin"), bytes);
  write_bytes(folder / "new/folder/a.bin", "second");
  EXPECT_EQ(read_bytes(folder / "new/folder/a.bin"), "second");
  std::size_t n = 0;
  for ([[maybe_unused]] const auto& entry :
       std::filesystem::directory_iterator(folder / "new/folder"))
    ++n;
  EXPECT_EQ(n, 1U);
}
TEST(Files, FullDiskIsAnErrorThatLeavesTheOldFileAndNothingHalfWritten) {
  const TestFolder folder;
  write_bytes(folder / "a.bin", "old");
  // a file size limit stops the write in its middle, as a full disk does
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit small{1000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string text = error_text(
      ErrorCode::bad_file, [&] { write_bytes(folder / "a.bin", std::string(5000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &old);
  EXPECT_TRUE(contains(text, "a.bin") && contains(text, "File too large")) << text;
  EXPECT_EQ(read_bytes(folder / "a.bin"), "old");
  std::size_t n = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++n;
  EXPECT_EQ(n, 1U);
}
TEST(Files, MissingFilesAndFoldersAreNamed) {
  const TestFolder folder;
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_file, [&] { read_bytes(folder / "no"); }),
                       "does not exist"));
  EXPECT_TRUE(
      contains(error_text(ErrorCode::bad_file, [&] { read_bytes(folder.path()); }), "is a folder"));
  write_bytes(folder / "file", "");
  EXPECT_TRUE(contains(error_text(ErrorCode::bad_file, [&] { write_bytes(folder / "file/a", ""); }),
                       "folder"));
}
TEST(Files, ExtensionsKeepTheirPrefix) {
  EXPECT_EQ(extension_of("a/T1.NII.GZ"), ".nii.gz");
  EXPECT_EQ(extension_of("a.b.ply"), ".ply");
  EXPECT_EQ(extension_of("bones.seg.nrrd"), ".seg.nrrd");
  EXPECT_EQ(stem_of("a/L.mrk.json"), "L");
  EXPECT_EQ(stem_of("a/b.c.ply"), "b.c");
}

}  // namespace
}  // namespace coxa::io
