#include "serve/viewing.h"

namespace coxa::serve {
namespace {
using Json = nlohmann::json;
namespace fs = std::filesystem;

/// An empty subject's folder that an image is sent to.
class Uploading : public test::Viewing {
 protected:
  static std::string bytes_of(const Volume& volume, const std::string& name) {
    const test::TempFolder scratch("coxa_upload_scratch");
    io::write_volume(scratch.path / name, volume, io::VoxelType::int16);
    return io::read_bytes(scratch.path / name);
  }
  int send(const std::string& name, const std::string& bytes,
           const std::string& batch = "0123456789abcdef", const test::Headers& headers = {}) {
    return static_cast<int>(
        put_bytes("/api/upload?batch=" + batch + "&name=" + name, bytes, headers).result_int());
  }
  int take(const std::string& batch = "0123456789abcdef", const std::string& movement = "gait") {
    return static_cast<int>(
        put("/api/image", {{"batch", batch}, {"side", "left"}, {"movement", movement}})
            .result_int());
  }
  /// What is in the folder beside the hidden one of files on their way.
  int n_entries() const {
    int n = 0;
    for (const auto& entry : fs::directory_iterator(folder.path))
      n += entry.path().filename().string().starts_with(".") ? 0 : 1;
    return n;
  }
};

TEST_F(Uploading, PutsAnImageInPlaceWithASubjectFile) {
  EXPECT_EQ(get("/api/case")["image"], nullptr);
  ASSERT_EQ(send("My%20Scan.NII.GZ", bytes_of(test::tiny_volume(), "a.nii.gz")), 200);
  EXPECT_EQ(n_entries(), 0);
  ASSERT_EQ(take(), 200);
  const Json after = get("/api/case");
  EXPECT_EQ(after["image"], "image.nii.gz");
  EXPECT_EQ(after["side"], "left");
  EXPECT_EQ(after["movement"], "gait");
  EXPECT_TRUE(after["can_run"].get<bool>()) << after["image_fault"];
  EXPECT_EQ(http->get("/api/image").body().substr(0, 4), "CXB1");
  EXPECT_EQ(n_entries(), 2);
  // a second one would take its place
  EXPECT_EQ(send("b.nii.gz", bytes_of(test::tiny_volume(), "b.nii.gz")), 400);
  EXPECT_EQ(take(), 400);
}
TEST_F(Uploading, TakesNamesFromNobody) {
  const std::string image = bytes_of(test::tiny_volume(), "a.nii.gz");
  for (const char* batch : {"", "..", "../../etc", "ABCDEF0123", "0123456", "01234567/../x",
                            "0123456789abcdef0123456789abcdef0"})
    EXPECT_EQ(send("a.nii.gz", image, batch), 400) << batch;
  // whatever the file is called, it is stored under a name of the server's
  EXPECT_EQ(send("..%2F..%2Fout.nii.gz", image), 200);
  EXPECT_EQ(take("0123456789abcdef", "../movements/gait"), 400);
  EXPECT_EQ(take("0123456789abcdef", ""), 400);
  EXPECT_EQ(take(), 200);
  EXPECT_TRUE(fs::exists(folder.path / "image.nii.gz"));
  EXPECT_FALSE(fs::exists(folder.path.parent_path() / "out.nii.gz"));
}
TEST_F(Uploading, RefusesHeadersThatPointToOtherFiles) {
  EXPECT_EQ(send("a.nrrd", "NRRD0004\ntype: uint8\ndata file: /etc/passwd\n\n"), 400);
  EXPECT_EQ(send("a.nrrd", "NRRD0004\nDataFile: /etc/passwd\r\n\r\n"), 400);
  EXPECT_EQ(send("a.mha", "NDims = 3\nElementDataFile = /etc/passwd\n"), 400);
  EXPECT_EQ(send("a.mha", "NDims = 3\n"), 400);
  EXPECT_EQ(send("a.mhd", "NDims = 3\nElementDataFile = LOCAL\n"), 400);
  EXPECT_EQ(send("a.nrrd", bytes_of(test::tiny_volume(), "a.nrrd")), 200);
  EXPECT_EQ(take(), 200);
}
TEST_F(Uploading, RefusesWhatIsNoImageAndLeavesNothing) {
  EXPECT_EQ(take(), 400);
  EXPECT_EQ(send("a.nii.gz", ""), 400);
  EXPECT_EQ(send("a.nii.gz", "no image"), 200);
  EXPECT_GE(take(), 400);
  EXPECT_EQ(take(), 400);  // it is gone
  EXPECT_EQ(send("IM0001", "no slice"), 200);
  EXPECT_EQ(send("IM0002", "no slice"), 200);
  EXPECT_EQ(send("b.nii.gz", "mixed"), 400);
  EXPECT_GE(take(), 400);
  EXPECT_EQ(n_entries(), 0);
}
TEST_F(Uploading, RefusesForeignSendersBeforeTheBody) {
  EXPECT_EQ(send("a.nii.gz", "x", "0123456789abcdef", {{"Origin", "http://evil.example"}}), 403);
  EXPECT_EQ(send("a.nii.gz", "x", "0123456789abcdef", {{"Host", "evil.example"}}), 403);
}
TEST_F(Uploading, LargeBodiesAreForImagesAlone) {
  EXPECT_EQ(send("a.nii.gz", std::string(5u << 20, 'x')), 200);
  // a length that is only claimed is refused before anything is read
  const auto claimed = [&](const std::string& target, const std::string& length) {
    auto socket = http->connected();
    boost::asio::write(socket,
                       boost::asio::buffer("PUT " + target + " HTTP/1.1\r\nHost: " + http->host() +
                                           "\r\nContent-Length: " + length + "\r\n\r\n"));
    std::string answer(12, ' ');
    boost::asio::read(socket, boost::asio::buffer(answer));
    return answer;
  };
  EXPECT_EQ(claimed("/api/landmarks", "5000000"), "HTTP/1.1 413");
  EXPECT_EQ(claimed("/api/upload?batch=0123456789abcdef&name=a", "99999999999"), "HTTP/1.1 413");
}
TEST_F(Uploading, TheOldestOfThreeUnfinishedGivesWay) {
  const std::string image = bytes_of(test::tiny_volume(), "a.nii.gz");
  for (const char* batch : {"00000001", "00000002", "00000003"})
    EXPECT_EQ(send("a.nii.gz", image, batch), 200);
  EXPECT_EQ(take("00000001"), 400);
  EXPECT_EQ(take("00000003"), 200);
}

}  // namespace
}  // namespace coxa::serve
