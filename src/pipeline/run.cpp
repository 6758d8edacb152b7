#include <coxa/pipeline/run.h>

#include <coxa/core/error.h>
#include <coxa/io/files.h>
#include <coxa/pipeline/joint_stage.h>
#include <coxa/pipeline/mesh_stage.h>
#include <coxa/pipeline/motion_stage.h>
#include <coxa/pipeline/report_stage.h>
#include <coxa/pipeline/segment_stage.h>
#include <coxa/pipeline/surface_stage.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {
using Json = nlohmann::json;

// shares of a whole run's time, measured on the demonstration: segmentation and mechanics dominate
constexpr double kShareDone[] = {0.0, 0.35, 0.45, 0.47, 0.97, 1.0};

class Run {
 public:
  Run(const Subject& subject, fs::path out, const RunOptions& options, const Monitor& monitor)
      : subject_(subject), out_(std::move(out)), options_(options), monitor_(monitor) {
    const auto* end = std::end(kStages);
    const auto* from = options.from ? std::find(std::begin(kStages), end, *options.from) : end;
    if (options.from && from == end) {
      fail(ErrorCode::usage, "there is no stage \"", *options.from,
           "\"; there are segment, mesh, motion, joint, report");
    }
    first_forced_ = from - std::begin(kStages);
  }

  std::vector<Record> all() {
    io::write_bytes(out_ / "subject.toml", io::read_bytes(subject_.file));
    add(0, [&](Reuse reuse, const Monitor& monitor) {
      if (!subject_.surfaces.empty())
        return run_surface_stage({subject_.surfaces, subject_.side, subject_.structures},
                                 out_ / "segment", reuse, monitor);
      SegmentRequest request{subject_.images, subject_.side, subject_.landmarks, subject_.atlas, {},
                             subject_.pins};
      request.labels = subject_.labels;
      request.options.on_found = options_.on_found;
      if (!subject_.structures.empty()) request.options.structures = subject_.structures;
      return run_segment_stage(request, out_ / "segment", reuse, monitor);
    });
    add(1, [&](Reuse reuse, const Monitor& monitor) {
      meshing::MeshingOptions options;
      if (subject_.mesh.layers > 1) options.layers = subject_.mesh.layers;
      options.max_tets = subject_.mesh.max_tets;
      return run_mesh_stage(out_ / "segment", options, out_ / "mesh", reuse, monitor);
    });
    add(2, [&](Reuse reuse, const Monitor& monitor) {
      return run_motion_stage(subject_, out_ / "segment", out_ / "motion", reuse, monitor);
    });
    add(3, [&](Reuse reuse, const Monitor& monitor) {
      return run_joint_stage(joint_request(), out_ / "joint", reuse, monitor);
    });
    add(4, [&](Reuse reuse, const Monitor& monitor) {
      return run_report_stage(subject_, out_, out_ / "report", reuse, monitor);
    });
    return records_;
  }

 private:
  JointRequest joint_request() const {
    const fs::path labrum = out_ / "segment" / "acetabular_labrum.vtp";
    const fs::path body = out_ / "mesh" / "acetabular_labrum.vtu";
    const bool soft = subject_.joint.labrum == "soft";
    require(!soft || fs::exists(body),
            "the joint is to have a soft labrum, but this run has none: structures does not name "
            "the labrum, or it could not be meshed (see log.txt)");
    return {subject_.side,
            out_ / "mesh" / "acetabular_cartilage.vtu",
            out_ / "mesh" / "femoral_cartilage.vtu",
            out_ / "segment" / "hip_bone.vtp",
            out_ / "segment" / "femur.vtp",
            out_ / "motion",
            subject_.joint,
            subject_.body_mass,
            fs::exists(labrum) ? labrum : fs::path(),
            soft ? body : fs::path()};
  }

  template <class Stage>
  void add(std::ptrdiff_t number, const Stage& stage) {
    const Reuse reuse = number >= first_forced_ ? Reuse::never : Reuse::if_unchanged;
    records_.push_back(stage(
        reuse, part_of(monitor_, kStages[number], kShareDone[number], kShareDone[number + 1])));
    if (options_.on_stage) options_.on_stage(records_.back());
    write_manifest();
  }

  void write_manifest() const {
    Json stages = Json::array();
    std::string log;
    for (const Record& record : records_) {
      stages.push_back(Json::parse(to_json(record)));
      log += join_text(record.verb, ": ", record.seconds, " s, ", record.peak_memory_mb, " MB\n");
      for (const std::string& text : record.warnings) log += "  warning: " + text + "\n";
    }
    const Json manifest{{"coxa_version", version()},
                        {"subject", subject_.name},
                        {"subject_file", fs::absolute(subject_.file).string()},
                        {"subject_file_sha256", io::sha256_of_path(subject_.file)},
                        {"stages", stages}};
    io::write_bytes(out_ / "manifest.json", manifest.dump(2) + "\n");
    io::write_bytes(out_ / "log.txt", log);
  }

  const Subject& subject_;
  fs::path out_;
  const RunOptions& options_;
  const Monitor& monitor_;
  std::ptrdiff_t first_forced_;
  std::vector<Record> records_;
};

}  // namespace

std::vector<Record> run_subject(const Subject& subject, const fs::path& out,
                                const RunOptions& options, const Monitor& monitor) {
  return Run(subject, out, options, monitor).all();
}

}  // namespace coxa::pipeline
