#include <coxa/pipeline/atlas_stage.h>

#include <coxa/io/atlas_file.h>
#include <coxa/io/files.h>
#include <coxa/pipeline/stage.h>
#include <coxa/shape/muscles.h>

#include <algorithm>

#include "muscle_examples.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

constexpr const char* kAttribution =
    "Computed from: LibHip and CarGen (github.com/diku-dk/libhip), MIT, (c) DIKU, Moshfeghifar et "
    "al. 2022, doi "
    "10.1016/j.cmpb.2022.107140. Visible Human set of the University of Denver, Andreassen et al. "
    "2023, doi "
    "10.1038/s41597-022-01905-2, CC BY 4.0 (renamed, decimated, axes changed). BMFToolkit, zlib "
    "(altered: fitted). HuBMAP "
    "CCF 3D Reference Object Library, CC BY 4.0 (altered: fitted). yuta-hi/pelvic-annonation, MIT.";

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

/// Those that the base was computed from: nobody left out there comes back with his muscles.
std::vector<shape::HipExample> known_to(const shape::Atlas& base,
                                        std::vector<shape::HipExample> examples) {
  std::erase_if(examples, [&](const shape::HipExample& example) {
    return std::find(base.subjects.begin(), base.subjects.end(), example.name) ==
           base.subjects.end();
  });
  return examples;
}

shape::Atlas built_atlas(const AtlasRequest& request, const Monitor& monitor) {
  auto examples = load_atlas_examples(request.data, request.examples, monitor);
  shape::Atlas atlas;
  if (request.base.empty()) {
    atlas = shape::build_atlas(examples, {}, monitor);
    update_atlas_profiles(atlas, request.profiles, monitor);
  } else {
    atlas = io::read_atlas(request.base);
    std::erase_if(atlas.structures, [](const auto& model) { return model.muscle; });
    examples = known_to(atlas, std::move(examples));
  }
  if (request.muscles) {
    const auto carried = shape::add_muscles(atlas, examples, muscle_names(), {}, monitor);
    update_muscle_profiles(atlas, carried, request.profiles, monitor);
  }
  atlas.attribution = kAttribution;
  return atlas;
}

}  // namespace

Record build_atlas_file(const AtlasRequest& request, const fs::path& out, const Monitor& monitor) {
  Record wanted;
  wanted.verb = "atlas";
  wanted.options = {{"exclude", joined(request.examples.exclude)},
                    {"exclude_structures", joined(request.examples.exclude_structures)},
                    {"muscles", request.muscles},
                    {"contrasts", joined(request.profiles.contrasts)},
                    {"profile_hips", std::int64_t{request.profiles.n_hips}},
                    {"seed", static_cast<std::int64_t>(request.profiles.seed)}};
  if (!request.base.empty()) wanted.inputs["base"] = io::sha256_of_path(request.base);
  const auto body = [&](const fs::path& partial, Record& record) {
    const shape::Atlas atlas = built_atlas(request, monitor);
    const fs::path file = partial / out.filename();
    io::write_atlas(file, atlas);
    record.figures["subjects"] = static_cast<std::int64_t>(atlas.subjects.size());
    for (const shape::StructureModel& model : atlas.structures) {
      record.figures[model.name + "_vertices"] =
          std::int64_t{model.hierarchy.levels.back().n_vertices()};
      record.figures[model.name + "_modes"] =
          static_cast<std::int64_t>(model.shape.deviations.size());
      record.figures[model.name + "_leave_one_out_mm"] = model.leave_one_out_error;
    }
    record.figures["size_mb"] = static_cast<double>(fs::file_size(file)) / 1e6;
  };
  return run_file(out, wanted, monitor, body);
}

}  // namespace coxa::pipeline
