#include <coxa/pipeline/surface_stage.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/io/surfaces.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/repair.h>
#include <coxa/pipeline/segment_stage.h>

#include "generic_structures.h"

namespace coxa::pipeline {
namespace {

Record wanted_record(const SurfaceRequest& request) {
  Record record;
  record.verb = "segment";
  record.options = {{"side", std::string(request.side == Side::left ? "left" : "right")},
                    {"source", std::string("surfaces given in place of an image")}};
  for (const auto& [name, path] : request.surfaces) record.inputs[name] = io::sha256_of_path(path);
  std::string list;
  for (const std::string& name : generic_among(request.structures))
    list += (list.empty() ? "" : ",") + name;
  if (!list.empty()) record.options["generic"] = list;
  return record;
}

Surface usable(const std::string& name, const std::filesystem::path& path, Record& record) {
  try {
    const Repaired repaired = repair(io::read_surface(path));
    for (const std::string& line : repaired.report.lines())
      record.warnings.push_back(name + ": " + line);
    return {repaired.mesh, {}};
  } catch (const Error& error) {
    fail(error.code(), name, " (", path.string(), "): ", error.what());
  }
}

}  // namespace

Record run_surface_stage(const SurfaceRequest& request, const std::filesystem::path& folder,
                         Reuse reuse, const Monitor& monitor) {
  const auto body = [&](const std::filesystem::path& partial, Record& record) {
    SurfaceSet surfaces;
    for (const auto& [name, path] : request.surfaces) {
      monitor.check_cancelled();
      surfaces[name] = usable(name, path, record);
      record.figures[name + "_volume_mm3"] = volume(surfaces[name].mesh);
    }
    for (const std::string& text : record.warnings) monitor.warn(text);
    add_generic(surfaces, request.structures, request.side, nullptr, record, monitor);
    add_thickness(surfaces);
    for (const auto& [name, surface] : surfaces) {
      io::write_surface(partial / (name + ".vtp"), surface);
      io::write_surface(partial / (name + ".ply"), surface);
    }
  };
  return run_stage(folder, wanted_record(request), reuse, monitor, body);
}

}  // namespace coxa::pipeline
