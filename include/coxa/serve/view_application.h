#pragma once

#include <coxa/serve/server.h>

#include <filesystem>
#include <functional>
#include <memory>

namespace coxa::serve {

/// The browser application over one subject's folder; what it answers is in docs/serve.md.
class ViewApplication : public Application {
 public:
  /// @param folder    the subject's; results, landmarks and movements are read and written here
  /// @param web_root  the built web application (index.html)
  /// @param other     a second result to compare with, only read; empty: none
  /// @throws Error bad_file if either is not there
  ViewApplication(const std::filesystem::path& folder, const std::filesystem::path& web_root,
                  const std::filesystem::path& other = {});
  ~ViewApplication() override;

  /// Where answers over the WebSocket go; before the server runs.
  void connect(Server& server);

  Response respond(const Request& request) override;
  std::size_t body_limit(const std::string& path) const override;
  void opened(ClientId client) override;
  void closed(ClientId client) override;
  void received(ClientId client, std::string text) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The built web application: $COXA_WEB, `web` beside the running program, or web/dist of the
/// source tree coxa was built from.
/// @throws Error bad_file naming the places, if it is in none of them
std::filesystem::path find_web_root();

}  // namespace coxa::serve
