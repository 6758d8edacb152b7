#pragma once

#include <coxa/core/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace coxa::io {

struct ConfigValue;

/// One table of a TOML file; remembers which keys were asked for, so that a misspelt one is found.
///
/// `T` is one of bool, Index, double, std::string, Vec3, std::vector<double>,
/// std::vector<std::string>. An integer is accepted where a double is asked for.
class Table {
 public:
  /// @throws Error bad_file if it cannot be read, bad_input with line and column if it is not TOML
  static Table read(const std::filesystem::path& path);

  bool has(const std::string& key) const;
  /// @throws Error bad_input if the key is missing or of another type
  template <class T>
  T get(const std::string& key) const;
  /// nullopt when the key is missing. @throws Error bad_input if it is of another type
  template <class T>
  std::optional<T> find(const std::string& key) const;
  /// The value, or `otherwise` when the key is missing.
  template <class T>
  T value_or(const std::string& key, const T& otherwise) const {
    return find<T>(key).value_or(otherwise);
  }
  /// A text value taken as a path, relative to the file's folder.
  std::optional<std::filesystem::path> find_path(const std::string& key) const;

  std::optional<Table> find_table(const std::string& key) const;
  /// The tables of `[[key]]`; a single `[key]` counts as one.
  std::vector<Table> tables(const std::string& key) const;
  /// All keys, in order of name.
  std::vector<std::string> keys() const;

  /// Call when every known key was asked for.
  /// @throws Error bad_input naming the first key that was not, its line, and the nearest known key
  void finish() const;
  /// "file:line: [table] key", for the caller's own messages.
  std::string where(const std::string& key) const;

 private:
  friend struct TableBuilder;
  std::filesystem::path file_;
  std::string name_;  ///< dotted, empty for the root
  std::map<std::string, ConfigValue> values_;
  mutable std::set<std::string> asked_;
};

struct ConfigValue {
  std::variant<bool, std::int64_t, double, std::string, std::vector<ConfigValue>, Table> value;
  int line = 0;
};

/// The known word with the smallest edit distance to `word`; nullopt when none is near (more than
/// half its length).
std::optional<std::string> nearest_word(const std::string& word,
                                        const std::vector<std::string>& known);

}  // namespace coxa::io
