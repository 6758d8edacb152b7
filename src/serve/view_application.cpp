#include <coxa/serve/view_application.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/serve/guard.h>

#include <cmath>
#include <cstdlib>

#include "case_folder.h"
#include "found_surfaces.h"
#include "job_runner.h"
#include "live_room.h"
#include "subject_edits.h"
#include "uploads.h"

namespace coxa::serve {
namespace fs = std::filesystem;
namespace {
using Json = nlohmann::json;

// pages of the folder (the report) bring their own style and pictures, and no script
constexpr const char* kReportPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; sandbox";
constexpr double kLargestAngle = radians(180.0);

std::string type_of(const fs::path& path) {
  static const std::map<std::string, std::string> types{{".html", "text/html; charset=utf-8"},
                                                        {".js", "text/javascript; charset=utf-8"},
                                                        {".css", "text/css; charset=utf-8"},
                                                        {".json", "application/json"},
                                                        {".svg", "image/svg+xml"},
                                                        {".png", "image/png"},
                                                        {".csv", "text/csv; charset=utf-8"},
                                                        {".txt", "text/plain; charset=utf-8"},
                                                        {".toml", "text/plain; charset=utf-8"}};
  const auto it = types.find(path.extension().string());
  return it == types.end() ? "application/octet-stream" : it->second;
}

Response error_response(int status, const std::string& text) {
  return text_response(status, "application/json", Json{{"error", text}}.dump());
}
Response bundle_response(std::string bytes) {
  return text_response(200, "application/octet-stream", std::move(bytes));
}
Response json_response(const Json& json) {
  return text_response(200, "application/json", json.dump());
}

Response file_response(const fs::path& root, std::string_view path, bool of_subject) {
  const auto file = file_inside(root, path);
  if (!file) return error_response(404, "there is no such file");
  Response response = text_response(200, type_of(*file), io::read_bytes(*file));
  if (of_subject) response.policy = kReportPolicy;
  return response;
}

Index index_of(const std::string& text) {
  char* end = nullptr;
  const long value = std::strtol(text.c_str(), &end, 10);
  require(!text.empty() && *end == '\0' && value >= 0 && value < 1000000, "index=", text,
          " is not the number of a frame");
  return static_cast<Index>(value);
}

double angle_of(const Json& json, const char* key) {
  const double angle = radians(json.at(key).get<double>());
  require(std::abs(angle) <= kLargestAngle, key, " must be within 180 degrees");
  return angle;
}

}  // namespace

struct ViewApplication::Impl {
  CaseFolder folder;
  std::optional<CaseFolder> other;  ///< a second result, to compare with; only read
  fs::path web_root;
  Uploads uploads{folder};
  FoundSurfaces found;
  Server* server = nullptr;
  LiveRoom live;
  JobRunner jobs;

  Impl(const fs::path& subject, const fs::path& web, const fs::path& compared)
      : folder(subject),
        other(compared.empty() ? std::nullopt : std::optional<CaseFolder>(compared)),
        web_root(web),
        live(folder,
             [this](ClientId client, Message message) {
               if (server != nullptr) server->send(client, std::move(message));
             }),
        jobs([this](const Json& json) { tell_all(json); }) {}

  static Message message(const Json& json) {
    return {Message::Kind::text, std::make_shared<const std::string>(json.dump())};
  }
  void tell(ClientId client, const Json& json) {
    if (server != nullptr) server->send(client, message(json));
  }
  void tell_all(const Json& json) {
    if (server != nullptr) server->send_to_all(message(json));
  }

  Response read(const Request& request);
  Response write(const Request& request);
  Response edited(const char* what, const std::optional<Json>& stored);
  void act(ClientId client, const Json& json);
  void start_job(ClientId client, const Json& json);
};

Response ViewApplication::Impl::read(const Request& request) {
  const std::string& path = request.path;
  const auto asked = [&](const char* key) { return query_value(request.query, key); };
  const bool of_other = asked("of") == "other";
  require(!of_other || other.has_value(), "there is no second result to compare with");
  const CaseFolder& source = of_other ? *other : folder;
  if (path == "/api/case") {
    Json json = source.overview();
    if (other && !of_other) json["other"] = other->folder().filename().string();
    return json_response(json);
  }
  if (path == "/api/surface") return bundle_response(source.surface(asked("name")));
  if (path == "/api/body") return bundle_response(source.body(asked("name")));
  if (path == "/api/frame") return bundle_response(source.frame(index_of(asked("index"))));
  if (path == "/api/image") return bundle_response(folder.image());
  if (path == "/api/landmarks") return json_response(stored_landmarks(folder));
  if (path == "/api/pins") return json_response(stored_pins(folder));
  if (path == "/api/job") return json_response(jobs.state());
  if (path == "/api/found") {
    const auto bytes = found.bundle(asked("name"));
    return bytes ? bundle_response(*bytes) : error_response(404, "nothing of that is found yet");
  }
  if (path.starts_with("/api/")) return error_response(404, "there is no such request");
  if (path.starts_with("/files/"))
    return file_response(folder.folder(), std::string_view(path).substr(7), true);
  return file_response(web_root, path == "/" ? "index.html" : path, false);
}

/// Points that were changed, told to the other windows; 409 where one of them was faster.
Response ViewApplication::Impl::edited(const char* what, const std::optional<Json>& stored) {
  if (!stored)
    return error_response(409, std::string("another window changed the ") + what + " meanwhile");
  tell_all({{"type", what}, {"version", stored->at("version")}});
  return json_response(*stored);
}

Response ViewApplication::Impl::write(const Request& request) {
  if (request.path == "/api/upload") {
    return json_response(uploads.add(query_value(request.query, "batch"),
                                     query_value(request.query, "name"), request.body));
  }
  const Json body = Json::parse(request.body, nullptr, false);
  if (body.is_discarded()) return error_response(400, "the body is not JSON");
  if (request.path == "/api/landmarks") return edited("landmarks", store_landmarks(folder, body));
  if (request.path == "/api/pins") return edited("pins", store_pins(folder, body));
  if (request.path == "/api/movement") return json_response(store_movement(folder, body));
  if (request.path == "/api/image") {
    const Json taken = uploads.take(body);
    tell_all({{"type", "image"}});
    return json_response(taken);
  }
  return error_response(404, "there is nothing to write there");
}

void ViewApplication::Impl::start_job(ClientId client, const Json& json) {
  const std::string name = json.at("job").get<std::string>();
  const auto show = [this](const SurfaceSet& surfaces) {
    found.set(surfaces);
    Json names = Json::array();
    for (const auto& [structure, surface] : surfaces) names.push_back(structure);
    tell_all({{"type", "found"}, {"names", names}});
  };
  const auto body = job_body(folder, json, show);
  const std::string refused = jobs.start(name, [this, body](const Monitor& monitor) {
    found.clear();
    body(monitor);
  });
  if (!refused.empty()) tell(client, {{"type", "error"}, {"text", refused}});
}

void ViewApplication::Impl::act(ClientId client, const Json& json) {
  const std::string type = json.at("type").get<std::string>();
  if (type == "pose") {
    live.pose(client, json.at("number").get<std::int64_t>(),
              {angle_of(json, "flexion_deg"), angle_of(json, "adduction_deg"),
               angle_of(json, "internal_rotation_deg")},
              json.value("field", "contact_pressure"));
  } else if (type == "settle") {
    live.settle(client, json.at("number").get<std::int64_t>());
  } else if (type == "live_leave") {
    live.leave(client);
  } else if (type == "job_start") {
    start_job(client, json);
  } else if (type == "job_cancel") {
    jobs.cancel();
  } else {
    tell(client, {{"type", "error"}, {"text", "there is no message \"" + type + "\""}});
  }
}

ViewApplication::ViewApplication(const fs::path& folder, const fs::path& web_root,
                                 const fs::path& other) {
  if (!fs::exists(web_root / "index.html")) {
    fail(coxa::ErrorCode::bad_file, web_root.string(),
         " holds no built web application; make web builds it");
  }
  impl_ = std::make_unique<Impl>(folder, web_root, other);
}
ViewApplication::~ViewApplication() = default;

void ViewApplication::connect(Server& server) { impl_->server = &server; }

Response ViewApplication::respond(const Request& request) {
  try {
    if (request.method == "GET" || request.method == "HEAD") return impl_->read(request);
    if (request.method == "PUT") return impl_->write(request);
    return error_response(405, "only GET and PUT are understood");
  } catch (const Error& error) {
    return error_response(error.code() == coxa::ErrorCode::bad_file ? 404 : 400, error.what());
  } catch (const nlohmann::json::exception& error) {
    return error_response(400, std::string("the request lacks something: ") + error.what());
  } catch (const std::exception& error) {
    return error_response(500, std::string("internal error: ") + error.what());
  }
}

std::size_t ViewApplication::body_limit(const std::string& path) const {
  return path == "/api/upload" ? Uploads::kLargestFile : 0;
}

void ViewApplication::opened(ClientId client) {
  impl_->tell(client, {{"type", "hello"}, {"job", impl_->jobs.state()}});
}

void ViewApplication::closed(ClientId client) { impl_->live.leave(client); }

void ViewApplication::received(ClientId client, std::string text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object())
    return impl_->tell(client, {{"type", "error"}, {"text", "this message is not JSON"}});
  try {
    impl_->act(client, json);
  } catch (const std::exception& error) {  // a key is missing, of another type or out of range
    impl_->tell(client, {{"type", "error"}, {"text", error.what()}});
  }
}

fs::path find_web_root() {
  std::vector<fs::path> places;
  if (const char* given = std::getenv("COXA_WEB")) {
    places.emplace_back(given);
  } else {
    std::error_code error;
    places.push_back(fs::read_symlink("/proc/self/exe", error).parent_path() / "web");
    places.emplace_back(COXA_WEB_DIR);
  }
  std::string tried;
  for (const fs::path& place : places) {
    if (fs::exists(place / "index.html")) return place;
    tried += "\n  " + place.string();
  }
  fail(coxa::ErrorCode::bad_file,
       "the web application is not built (make web builds it); looked in", tried);
}

}  // namespace coxa::serve
