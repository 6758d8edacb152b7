#pragma once

#include <coxa/core/monitor.h>
#include <coxa/pipeline/record.h>

#include <filesystem>
#include <functional>

namespace coxa::pipeline {

enum class Reuse { if_unchanged, never };

/// Whether `folder` holds a result whose record has the same key.
bool holds_result(const std::filesystem::path& folder, const Record& wanted);

/// Runs one stage into `folder`, whole or not at all.
///
/// The body fills a sibling folder `<name>.partial`, which is renamed into place at the end, with
/// the record as
/// `<verb>.json` inside. Where `folder` holds a record with the same key the body is not run again.
/// A body that throws leaves an earlier result as it was and removes what it had begun.
/// @param wanted  verb, options and inputs; the body adds figures and warnings
/// Ctrl-C counts up to the moment the result is put in place.
/// @returns the record of the result now in `folder`
Record run_stage(
    const std::filesystem::path& folder, Record wanted, Reuse reuse, const Monitor& monitor,
    const std::function<void(const std::filesystem::path& partial, Record& record)>& body);

/// The same for a verb whose result is one file: it, whatever else the body wrote, and the record
/// `<stem>.json` appear beside each other, all or none.
///
/// The body writes into a folder of its own beside `out`; what is there is then moved into place.
/// @param body  writes `partial / out.filename()`, and files named after its stem
/// @throws Error bad_file if a file cannot be written or put in place
Record run_file(
    const std::filesystem::path& out, Record wanted, const Monitor& monitor,
    const std::function<void(const std::filesystem::path& partial, Record& record)>& body);

}  // namespace coxa::pipeline
