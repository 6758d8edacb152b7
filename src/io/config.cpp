#include <coxa/io/config.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>

#include <toml++/toml.h>
#include <algorithm>
#include <numeric>

namespace coxa::io {

/// Turns the parser's nodes into ours.
struct TableBuilder {
  const std::filesystem::path& file;

  ConfigValue value(const toml::node& node, const std::string& name) const {
    ConfigValue result;
    result.line = static_cast<int>(node.source().begin.line);
    if (const auto* flag = node.as_boolean()) result.value = flag->get();
    if (const auto* integer = node.as_integer()) result.value = integer->get();
    if (const auto* number = node.as_floating_point()) result.value = number->get();
    if (const auto* text = node.as_string()) result.value = text->get();
    if (const auto* inner = node.as_table()) result.value = table(*inner, name);
    if (const auto* array = node.as_array()) {
      std::vector<ConfigValue> items;
      for (const toml::node& item : *array) items.push_back(value(item, name));
      result.value = std::move(items);
    }
    return result;
  }

  Table table(const toml::table& node, const std::string& name) const {
    Table result;
    result.file_ = file;
    result.name_ = name;
    for (const auto& [key, child] : node) {
      const std::string word(key.str());
      result.values_[word] = value(child, name.empty() ? word : name + "." + word);
    }
    return result;
  }
};

namespace {

template <class T>
struct Reader;

template <>
struct Reader<bool> {
  static constexpr const char* kName = "true or false";
  static std::optional<bool> read(const ConfigValue& v) {
    const bool* flag = std::get_if<bool>(&v.value);
    return flag ? std::optional(*flag) : std::nullopt;
  }
};
template <>
struct Reader<Index> {
  static constexpr const char* kName = "a whole number";
  static std::optional<Index> read(const ConfigValue& v) {
    const std::int64_t* number = std::get_if<std::int64_t>(&v.value);
    const bool fits = number && *number == static_cast<Index>(*number);
    return fits ? std::optional(static_cast<Index>(*number)) : std::nullopt;
  }
};
template <>
struct Reader<double> {
  static constexpr const char* kName = "a number";
  static std::optional<double> read(const ConfigValue& v) {
    if (const double* number = std::get_if<double>(&v.value)) return *number;
    const std::int64_t* integer = std::get_if<std::int64_t>(&v.value);
    return integer ? std::optional(static_cast<double>(*integer)) : std::nullopt;
  }
};
template <>
struct Reader<std::string> {
  static constexpr const char* kName = "a text in quotes";
  static std::optional<std::string> read(const ConfigValue& v) {
    const std::string* text = std::get_if<std::string>(&v.value);
    return text ? std::optional(*text) : std::nullopt;
  }
};
template <class T>
struct Reader<std::vector<T>> {
  static constexpr const char* kName = "a list of values of one kind";
  static std::optional<std::vector<T>> read(const ConfigValue& v) {
    const auto* items = std::get_if<std::vector<ConfigValue>>(&v.value);
    if (!items) return std::nullopt;
    std::vector<T> result;
    for (const ConfigValue& item : *items) {
      const std::optional<T> entry = Reader<T>::read(item);
      if (!entry) return std::nullopt;
      result.push_back(*entry);
    }
    return result;
  }
};
template <>
struct Reader<Vec3> {
  static constexpr const char* kName = "a list of three numbers";
  static std::optional<Vec3> read(const ConfigValue& v) {
    const auto numbers = Reader<std::vector<double>>::read(v);
    if (!numbers || numbers->size() != 3) return std::nullopt;
    return Vec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  }
};

Index edit_distance(const std::string& a, const std::string& b) {
  std::vector<Index> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    Index diagonal = row[0];
    row[0] = static_cast<Index>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const Index replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

}  // namespace

std::optional<std::string> nearest_word(const std::string& word,
                                        const std::vector<std::string>& known) {
  std::optional<std::string> best;
  Index best_distance = static_cast<Index>(word.size() / 2 + 1);
  for (const std::string& candidate : known) {
    const Index distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

Table Table::read(const std::filesystem::path& path) {
  try {
    return TableBuilder{path}.table(toml::parse(read_bytes(path), path.string()), "");
  } catch (const toml::parse_error& error) {
    fail(ErrorCode::bad_input, path.string(), ":", error.source().begin.line, ":",
         error.source().begin.column, ": ", error.description());
  }
}

bool Table::has(const std::string& key) const {
  asked_.insert(key);
  return values_.count(key) > 0;
}

template <class T>
std::optional<T> Table::find(const std::string& key) const {
  if (!has(key)) return std::nullopt;
  const std::optional<T> value = Reader<T>::read(values_.at(key));
  require(value.has_value(), where(key), " must be ", Reader<T>::kName);
  return value;
}

template <class T>
T Table::get(const std::string& key) const {
  const std::optional<T> value = find<T>(key);
  require(value.has_value(), file_.string(), ": ", name_.empty() ? "" : "[" + name_ + "] ",
          "needs the key ", key, " (", Reader<T>::kName, ")");
  return *value;
}

std::optional<std::filesystem::path> Table::find_path(const std::string& key) const {
  const auto text = find<std::string>(key);
  if (!text) return std::nullopt;
  return (file_.parent_path() / *text).lexically_normal();
}

std::optional<Table> Table::find_table(const std::string& key) const {
  if (!has(key)) return std::nullopt;
  const Table* table = std::get_if<Table>(&values_.at(key).value);
  require(table != nullptr, where(key), " must be a table");
  return *table;
}

std::vector<Table> Table::tables(const std::string& key) const {
  if (!has(key)) return {};
  const ConfigValue& value = values_.at(key);
  if (const Table* table = std::get_if<Table>(&value.value)) return {*table};
  const auto* items = std::get_if<std::vector<ConfigValue>>(&value.value);
  require(items != nullptr, where(key), " must be a table or a list of tables");
  std::vector<Table> result;
  for (const ConfigValue& item : *items) {
    const Table* table = std::get_if<Table>(&item.value);
    require(table != nullptr, where(key), " must hold only tables");
    result.push_back(*table);
  }
  return result;
}

std::vector<std::string> Table::keys() const {
  std::vector<std::string> names;
  for (const auto& [key, value] : values_) names.push_back(key);
  return names;
}

void Table::finish() const {
  for (const auto& [key, value] : values_) {
    if (asked_.count(key)) continue;
    const auto nearest = nearest_word(key, {asked_.begin(), asked_.end()});
    fail(ErrorCode::bad_input, where(key), " is not a known key",
         nearest ? "; did you mean " + *nearest + "?" : std::string());
  }
}

std::string Table::where(const std::string& key) const {
  const auto found = values_.find(key);
  const std::string line = found == values_.end() ? "" : join_text(':', found->second.line);
  return file_.string() + line + ": " + (name_.empty() ? "" : join_text('[', name_, "] ")) + key;
}

#define COXA_INSTANTIATE(T)                           \
  template T Table::get<T>(const std::string&) const; \
  template std::optional<T> Table::find<T>(const std::string&) const;
COXA_INSTANTIATE(bool)
COXA_INSTANTIATE(Index)
COXA_INSTANTIATE(double)
COXA_INSTANTIATE(std::string)
COXA_INSTANTIATE(Vec3)
COXA_INSTANTIATE(std::vector<double>)
COXA_INSTANTIATE(std::vector<std::string>)
#undef COXA_INSTANTIATE

}  // namespace coxa::io
