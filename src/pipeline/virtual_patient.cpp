#include <coxa/pipeline/virtual_patient.h>

#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/io/atlas_file.h>
#include <coxa/io/files.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/volumes.h>
#include <coxa/pipeline/stage.h>
#include <coxa/shape/build_atlas.h>
#include <coxa/shape/hip_structures.h>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

// a right hip's head centre lies about so far to the right of the body's middle, mm
constexpr double kHeadFromMiddle = 90.0;
// the shell of cortical bone around the pelvis' marrow, mm
constexpr double kPelvicCortex = 1.0;

/// From the atlas frame to the scanner's: mirrored for a left hip, the body's middle at x = 0.
Vec3 in_scanner(const Vec3& p, Side side) {
  const double x = p.x() - kHeadFromMiddle;
  return {side == Side::left ? -x : x, p.y(), p.z()};
}

TriMesh in_scanner(TriMesh mesh, Side side) {
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    mesh.points.row(v) = in_scanner(Vec3(mesh.points.row(v)), side);
  if (side == Side::left) mesh.triangles.col(1).swap(mesh.triangles.col(2));
  return mesh;
}

std::vector<TissueSurface> tissues(const shape::VirtualHip& hip, const Vec3& head) {
  std::vector<TissueSurface> list;
  for (const char* name : shape::kHipStructures) {
    const auto it = hip.find(name);
    if (it == hip.end()) continue;
    const TriMesh& mesh = it->second;
    TissueSurface tissue{mesh.points, mesh.triangles, Tissue::cartilage, {}};
    if (std::string(name) == "femur") tissue.shell = shell_thicker_below(mesh.points, head);
    if (std::string(name) == "hip_bone")
      tissue.shell = VecX::Constant(mesh.n_vertices(), kPelvicCortex);
    if (tissue.shell.size() > 0) tissue.tissue = Tissue::marrow;
    list.push_back(std::move(tissue));
  }
  return list;
}

shape::Landmarks noisy_landmarks(const shape::VirtualHip& hip, const VirtualPatientRequest& request,
                                 const Volume& image, Rng& rng) {
  shape::Landmarks noisy;
  const std::string suffix = request.side == Side::left ? "_left" : "_right";
  for (const auto& [name, p] : shape::find_landmarks(hip)) {
    const Vec3 place = in_scanner(p, request.side) + request.landmark_error * rng.normal3();
    if (in_view(image, place)) noisy[name + suffix] = place;
  }
  return noisy;
}

std::string subject_toml(const VirtualPatientRequest& request) {
  return join_text(
      "# A virtual patient, seed ", request.seed, ": no person.\nname = \"virtual_patient_",
      request.seed, "\"\nside = \"", request.side == Side::left ? "left" : "right",
      "\"\n\n[image]\npath = \"image.nii.gz\"\n\n[landmarks]\npath = \"landmarks.mrk.json\"\n\n",
      "[motion]\npattern = \"flexion_internal_rotation\"\nframes = 13\n\n",
      "[mesh]\nmax_tets = 12000\n");
}

void check_request(const VirtualPatientRequest& request) {
  require(request.landmark_error >= 0.0, "landmark error must not be negative, got ",
          request.landmark_error, " mm");
}

}  // namespace

PhantomOptions unlike_training() {
  PhantomOptions options;
  options.voxel = Vec3(0.75, 0.75, 1.0);
  options.field_of_view = Vec3(150.0, 150.0, 180.0);
  options.snr = 17.0;
  options.bias = 0.3;
  options.texture = 0.07;
  options.fat_shift = 0.6;
  return options;
}

Record make_virtual_patient(const VirtualPatientRequest& request, const fs::path& folder,
                            const Monitor& monitor) {
  check_request(request);
  Record wanted;
  wanted.verb = "phantom";
  wanted.options = {{"side", std::string(request.side == Side::left ? "left" : "right")},
                    {"seed", static_cast<std::int64_t>(request.seed)},
                    {"spread", request.shape.spread},
                    {"off_model_rms_mm", request.shape.off_model_rms},
                    {"snr", request.image.snr},
                    {"landmark_error_mm", request.landmark_error}};
  wanted.inputs["atlas"] = io::sha256_of_path(request.atlas);
  const auto body = [&](const fs::path& partial, Record& record) {
    Rng rng(request.seed);
    const shape::VirtualHip hip =
        shape::draw_virtual_hip(io::read_atlas(request.atlas), rng, request.shape);
    shape::VirtualHip placed;
    for (const auto& [name, mesh] : hip) {
      placed[name] = in_scanner(mesh, request.side);
      io::write_surface(partial / "truth" / (name + ".ply"), placed[name]);
    }
    const Vec3 head = in_scanner(Vec3::Zero().eval(), request.side);
    PhantomOptions image_options = request.image;
    image_options.centre =
        head - Vec3(0.0, 0.0, 10.0);  // a hip MRI shows more of the femur than of the ilium
    image_options.body_centre = Vec3(0.0, head.y() + 20.0, head.z());
    image_options.seed = request.seed;
    const Volume image =
        simulate_mri(tissues(placed, head), image_options, part_of(monitor, "phantom", 0.1, 0.95));
    io::write_volume(partial / "image.nii.gz", image);
    io::write_landmarks(partial / "landmarks.mrk.json", noisy_landmarks(hip, request, image, rng));
    io::write_bytes(partial / "subject.toml", subject_toml(request));
    record.figures["structures"] = static_cast<std::int64_t>(hip.size());
  };
  return run_stage(folder, wanted, Reuse::never, monitor, body);
}

}  // namespace coxa::pipeline
