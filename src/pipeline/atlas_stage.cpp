#include <coxa/pipeline/atlas_stage.h>

#include <coxa/io/atlas_file.h>
#include <coxa/pipeline/stage.h>

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

}  // namespace

Record build_atlas_file(const AtlasRequest& request, const fs::path& out, const Monitor& monitor) {
  Record wanted;
  wanted.verb = "atlas";
  wanted.options = {{"exclude", joined(request.examples.exclude)},
                    {"exclude_structures", joined(request.examples.exclude_structures)},
                    {"contrasts", joined(request.profiles.contrasts)},
                    {"profile_hips", std::int64_t{request.profiles.n_hips}},
                    {"seed", static_cast<std::int64_t>(request.profiles.seed)}};
  const auto body = [&](const fs::path& partial, Record& record) {
    const auto examples = load_atlas_examples(request.data, request.examples, monitor);
    shape::Atlas atlas = shape::build_atlas(examples, {}, monitor);
    update_atlas_profiles(atlas, request.profiles, monitor);
    atlas.attribution = kAttribution;
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
