#pragma once

#include <coxa/core/monitor.h>
#include <coxa/pipeline/stage.h>
#include <coxa/pipeline/subject.h>

#include <filesystem>

namespace coxa::pipeline {

/// Pictures and report.html of a finished run into `folder`: MR slices with contours, the surfaces,
/// the acetabular cartilage coloured by strain and by pressure at six frames, curves over the
/// movement, all figures and warnings.
/// @param run_folder  holds segment, mesh, motion and joint
Record run_report_stage(const Subject& subject, const std::filesystem::path& run_folder,
                        const std::filesystem::path& folder, Reuse reuse, const Monitor& monitor);

}  // namespace coxa::pipeline
