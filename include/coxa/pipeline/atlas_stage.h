#pragma once

#include <coxa/core/monitor.h>
#include <coxa/pipeline/atlas_examples.h>
#include <coxa/pipeline/atlas_profiles.h>
#include <coxa/pipeline/record.h>

#include <filesystem>

namespace coxa::pipeline {

struct AtlasRequest {
  std::filesystem::path data = "../shared/data";
  AtlasExampleOptions examples;
  AtlasProfileOptions profiles;
  bool muscles = true;
  /// An atlas whose bones and cartilages are taken as they are; empty: they are built. Only
  /// examples that it was computed from give muscles.
  std::filesystem::path base;
};

/// Builds an atlas and writes it whole, with `<stem>.json` beside it.
Record build_atlas_file(const AtlasRequest& request, const std::filesystem::path& out,
                        const Monitor& monitor);

}  // namespace coxa::pipeline
