#include <coxa/pipeline/record.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <sys/resource.h>

#include <nlohmann/json.hpp>

namespace coxa::pipeline {
namespace {
using Json = nlohmann::json;

Json to_object(const Fields& fields) {
  Json object = Json::object();
  for (const auto& [key, value] : fields) {
    object[key] = std::visit([](const auto& v) { return Json(v); }, value);
  }
  return object;
}

Fields from_object(const Json& object) {
  Fields fields;
  for (const auto& [key, value] : object.items()) {
    if (value.is_boolean()) fields[key] = value.get<bool>();
    if (value.is_number_integer()) fields[key] = value.get<std::int64_t>();
    if (value.is_number_float()) fields[key] = value.get<double>();
    if (value.is_null()) fields[key] = std::numeric_limits<double>::quiet_NaN();
    if (value.is_string()) fields[key] = value.get<std::string>();
  }
  return fields;
}

}  // namespace

std::string version() { return COXA_VERSION; }

std::string record_key(const Record& record) {
  const Json ground{{"version", version()},
                    {"verb", record.verb},
                    {"options", to_object(record.options)},
                    {"inputs", record.inputs}};
  return io::sha256_of_bytes(ground.dump());
}

std::string to_json(const Record& record) {
  const Json json{{"coxa_version", version()},
                  {"verb", record.verb},
                  {"key", record_key(record)},
                  {"options", to_object(record.options)},
                  {"inputs_sha256", record.inputs},
                  {"figures", to_object(record.figures)},
                  {"warnings", record.warnings},
                  {"seconds", record.seconds},
                  {"peak_memory_mb", record.peak_memory_mb}};
  return json.dump(2) + "\n";
}

void write_record(const std::filesystem::path& path, const Record& record) {
  io::write_bytes(path, to_json(record));
}

Record read_record(const std::filesystem::path& path) {
  try {
    const Json json = Json::parse(io::read_bytes(path));
    Record record;
    record.verb = json.at("verb").get<std::string>();
    record.options = from_object(json.at("options"));
    record.inputs = json.at("inputs_sha256").get<std::map<std::string, std::string>>();
    record.figures = from_object(json.at("figures"));
    record.warnings = json.at("warnings").get<std::vector<std::string>>();
    record.seconds = json.at("seconds").get<double>();
    record.peak_memory_mb = json.at("peak_memory_mb").get<double>();
    return record;
  } catch (const Json::exception& error) {
    fail(ErrorCode::bad_file, path.string(), " is not a record of coxa: ", error.what());
  }
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux gives kilobytes
}

}  // namespace coxa::pipeline
