#include "normal_curves.h"

#include <coxa/core/error.h>
#include <coxa/io/config.h>
#include <coxa/pipeline/subject.h>

#include <algorithm>

namespace coxa::serve {
using Json = nlohmann::json;

Json normal_curves() {
  Json list = Json::array();
  const io::Table root = io::Table::read(pipeline::shipped_data("normal_curves.toml"));
  for (const io::Table& table : root.tables("curve")) {
    const auto percent = table.get<std::vector<double>>("percent");
    const auto low = table.get<std::vector<double>>("low");
    const auto high = table.get<std::vector<double>>("high");
    require(percent.size() >= 2 && low.size() == percent.size() && high.size() == percent.size(),
            table.where("percent"), ", low and high must be of one length, at least 2");
    require(std::is_sorted(percent.begin(), percent.end()), table.where("percent"),
            " must not decrease");
    list.push_back({{"movement", table.get<std::string>("movement")},
                    {"angle", table.get<std::string>("angle")},
                    {"source", table.get<std::string>("source")},
                    {"percent", percent},
                    {"low", low},
                    {"high", high}});
    table.finish();
  }
  root.finish();
  return list;
}

}  // namespace coxa::serve
