#include <coxa/serve/guard.h>
#include <coxa/serve/view_application.h>

#include "commands.h"

namespace coxa::app {
namespace {

struct ViewArguments {
  std::string folder, other, listen = "127.0.0.1";
  int port = 8080;
};

void run_view(const ViewArguments& arguments, Context& context) {
  serve::ViewApplication application(arguments.folder, serve::find_web_root(), arguments.other);
  serve::ServerOptions options;
  options.address = arguments.listen;
  options.port = static_cast<std::uint16_t>(arguments.port);
  // a token only where others could reach the server
  const bool own = options.address == "127.0.0.1" || options.address == "::1";
  if (!own) options.token = serve::make_token();
  serve::Server server(application, options);
  application.connect(server);

  const std::string host = options.address == "::1" ? "[::1]" : options.address;
  const std::string address = "http://" + host + ":" + std::to_string(server.port()) + "/" +
                              (own ? "" : "?token=" + options.token);
  const Monitor monitor = context.monitor();
  context.announce(address, "open " + address + " in a browser; Ctrl-C ends");
  server.run(monitor);
}

}  // namespace

void add_view(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand("view", "the browser application over a subject's folder");
  auto arguments = std::make_shared<ViewArguments>();
  verb->add_option("folder", arguments->folder, "a subject's folder, finished or just begun")
      ->required()
      ->check(CLI::ExistingDirectory);
  verb->add_option("--compare", arguments->other, "a second result, shown beside the first")
      ->check(CLI::ExistingDirectory);
  verb->add_option("--port", arguments->port, "port; 0 takes any free one")
      ->check(CLI::Range(0, 65535));
  verb->add_option("--listen", arguments->listen,
                   "IP address to listen on; any but this machine's own needs the token printed");
  verb->callback([arguments, &context] { run_view(*arguments, context); });
}

}  // namespace coxa::app
