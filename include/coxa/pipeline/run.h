#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/surface_set.h>
#include <coxa/pipeline/stage.h>
#include <coxa/pipeline/subject.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace coxa::pipeline {

/// The stages of a run, in order; also their folders' names.
inline constexpr const char* kStages[] = {"segment", "mesh", "motion", "joint", "report"};

struct RunOptions {
  std::optional<std::string>
      from;  ///< run this stage and all after it again; none: what has changed
  std::function<void(const Record&)> on_stage = {};  ///< called with the record of each stage done
  std::function<void(const SurfaceSet&)> on_found = {};  ///< as of SegmentOptions
};

/// The whole chain of one subject into `out`: a folder per stage, manifest.json, log.txt and a copy
/// of the subject file.
///
/// A stage whose inputs and options are those of the result at hand is kept. Ctrl-C keeps the
/// finished stages.
/// @returns the records of all stages, in order
/// @throws Error usage for an unknown stage; what the stages throw
std::vector<Record> run_subject(const Subject& subject, const std::filesystem::path& out,
                                const RunOptions& options, const Monitor& monitor);

}  // namespace coxa::pipeline
