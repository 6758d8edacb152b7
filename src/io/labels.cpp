#include <coxa/io/labels.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/volumes.h>

#include "volume_formats.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace coxa::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using KeyValues = std::vector<std::pair<std::string, std::string>>;

/// Which of 0 … 255 occur. @throws Error bad_input for any other value
std::array<bool, 256> values_in(const Volume& volume, const std::string& source) {
  std::array<bool, 256> present{};
  for (const float value : volume.values) {
    require(value >= 0.0F && value <= 255.0F && value == std::floor(value), source,
            " is not a label map: a voxel is ", value);
    present[static_cast<std::size_t>(value)] = true;
  }
  return present;
}

std::vector<Label> unnamed_labels(const Volume& volume, const std::string& source) {
  const std::array<bool, 256> present = values_in(volume, source);
  std::vector<Label> labels;
  for (int value = 1; value < 256; ++value) {
    if (present[static_cast<std::size_t>(value)])
      labels.push_back({.value = value, .name = join_text("label_", value)});
  }
  return labels;
}

fs::path names_beside(const fs::path& path) {
  return path.parent_path() / (stem_of(path) + ".json");
}

std::vector<Label> labels_from_json(const fs::path& path) {
  std::vector<Label> labels;
  try {
    const Json json = Json::parse(read_bytes(path));
    for (const auto& [value, entry] : json.items()) {
      Label label;
      label.value = std::stoi(value);
      label.name =
          entry.is_string() ? entry.get<std::string>() : entry.at("name").get<std::string>();
      if (entry.is_object()) {
        label.colour = entry.at("colour").get<std::array<double, 3>>();
        label.generic = entry.value("generic", false);
      }
      labels.push_back(label);
    }
  } catch (const std::invalid_argument&) {
    fail(ErrorCode::bad_file, path.string(), ": the keys must be label numbers");
  } catch (const Json::exception& error) {
    fail(ErrorCode::bad_file, path.string(), " does not name labels: ", error.what());
  }
  std::sort(labels.begin(), labels.end(),
            [](const Label& a, const Label& b) { return a.value < b.value; });
  return labels;
}

std::string format_names(const std::vector<Label>& labels) {
  Json json = Json::object();
  for (const Label& label : labels) {
    Json& entry = json[std::to_string(label.value)];
    entry = {{"name", label.name}, {"colour", label.colour}};
    if (label.generic) entry["generic"] = true;
  }
  return json.dump(2) + "\n";
}

/// Slicer writes each segment as Segment0_Name, Segment0_LabelValue, Segment0_Color, …
std::vector<Label> labels_from_segments(const KeyValues& pairs, const std::string& source) {
  const std::map<std::string, std::string> values(pairs.begin(), pairs.end());
  std::vector<Label> labels;
  for (int n = 0; values.contains(join_text("Segment", n, "_ID")); ++n) {
    const auto text = [&](const char* field) {
      const auto found = values.find(join_text("Segment", n, '_', field));
      return found == values.end() ? std::string() : found->second;
    };
    Label label;
    label.name = text("Name");
    std::istringstream value(text("LabelValue")), colour(text("Color"));
    if (!(value >> label.value))
      fail(ErrorCode::bad_file, source, ": segment ", n, " has no LabelValue");
    for (double& c : label.colour) colour >> c;
    labels.push_back(label);
  }
  std::sort(labels.begin(), labels.end(),
            [](const Label& a, const Label& b) { return a.value < b.value; });
  return labels;
}

/// First and last index of a label along each axis; 0 -1 where it does not occur.
std::string extent_of(const Volume& volume, int value) {
  std::array<Index, 3> low = volume.size, high = {-1, -1, -1};
  for (Index k = 0; k < volume.size[2]; ++k) {
    for (Index j = 0; j < volume.size[1]; ++j) {
      for (Index i = 0; i < volume.size[0]; ++i) {
        if (volume.values[static_cast<std::size_t>(volume.offset(i, j, k))] !=
            static_cast<float>(value))
          continue;
        const std::array<Index, 3> at = {i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], at[a]);
          high[a] = std::max(high[a], at[a]);
        }
      }
    }
  }
  if (high[0] < 0) low = {0, 0, 0};
  return join_text(low[0], ' ', high[0], ' ', low[1], ' ', high[1], ' ', low[2], ' ', high[2]);
}

KeyValues segments_of(const LabelMap& map) {
  KeyValues pairs = {{"Segmentation_MasterRepresentation", "Binary labelmap"},
                     {"Segmentation_ContainedRepresentationNames", "Binary labelmap|"}};
  for (std::size_t n = 0; n < map.labels.size(); ++n) {
    const Label& label = map.labels[n];
    const auto add = [&](const char* field, const std::string& value) {
      pairs.emplace_back(join_text("Segment", n, '_', field), value);
    };
    add("ID", label.name);
    add("Name", label.name);
    add("NameAutoGenerated", "0");
    add("LabelValue", std::to_string(label.value));
    add("Layer", "0");
    add("Color", join_text(label.colour[0], ' ', label.colour[1], ' ', label.colour[2]));
    add("ColorAutoGenerated", "0");
    add("Extent", extent_of(map.volume, label.value));
    add("Tags", "|");
  }
  return pairs;
}

}  // namespace

LabelMap read_labels(const fs::path& path) {
  LabelMap map;
  map.volume = read_volume(path);
  const std::vector<Label> unnamed = unnamed_labels(map.volume, path.string());
  if (extension_of(path) == ".seg.nrrd") {
    map.labels = labels_from_segments(nrrd_key_values(read_bytes(path)), path.string());
  } else if (fs::exists(names_beside(path))) {
    map.labels = labels_from_json(names_beside(path));
  }
  if (map.labels.empty()) map.labels = unnamed;
  return map;
}

void write_labels(const fs::path& path, const LabelMap& map) {
  const std::string extension = extension_of(path), target = path.string();
  std::array<bool, 256> missing = values_in(map.volume, target);
  missing[0] = false;
  for (const Label& label : map.labels) {
    require(1 <= label.value && label.value <= 255, "label ", label.name, " for ", target,
            " must be in [1, 255], got ", label.value);
    missing[static_cast<std::size_t>(label.value)] = false;
  }
  const auto first = std::find(missing.begin(), missing.end(), true);
  require(first == missing.end(), "value ", first - missing.begin(), " in the label map for ",
          target, " has no label");
  if (extension == ".seg.nrrd") {
    return write_bytes(path, format_nrrd(map.volume, VoxelType::uint8, segments_of(map), target));
  }
  require(extension == ".nii" || extension == ".nii.gz", "cannot write labels to ", target,
          ": known are .nii, .nii.gz, .seg.nrrd");
  write_volume(path, map.volume, VoxelType::uint8);
  write_bytes(names_beside(path), format_names(map.labels));
}

}  // namespace coxa::io
