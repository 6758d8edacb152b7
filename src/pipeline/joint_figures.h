#pragma once

#include <coxa/joint/joint_result.h>
#include <coxa/pipeline/record.h>

namespace coxa::pipeline {

/// Puts what a joint's result comes to into the record, with warnings of frames that failed and of
/// pressures not to be trusted.
void add_joint_figures(const joint::JointResult& result, Record& record);

}  // namespace coxa::pipeline
