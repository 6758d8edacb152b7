#include "case_folder.h"

#include "pose_json.h"

#include <coxa/core/error.h>
#include <coxa/io/config.h>
#include <coxa/io/files.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/tets.h>
#include <coxa/serve/bundle.h>

#include <algorithm>

#include "csv_table.h"
#include "normal_curves.h"
#include "stored_frame.h"

namespace coxa::serve {
namespace fs = std::filesystem;
namespace {
using Json = nlohmann::json;

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json read_json(const fs::path& path) {
  const Json json = Json::parse(io::read_bytes(path), nullptr, false);
  if (json.is_discarded()) fail(coxa::ErrorCode::bad_file, path.string(), " is not JSON");
  return json;
}

Json field_list() {
  Json list = Json::array();
  for (const FieldName& field : kFrameFields)
    list.push_back({{"key", field.key}, {"label", field.label}, {"unit", field.unit}});
  list.push_back({{"key", "thickness"}, {"label", "thickness"}, {"unit", "mm"}});
  return list;
}

Json movement_list() {
  Json names = Json::array();
  std::error_code error;
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(pipeline::shipped_data("movements"), error)) {
    if (entry.path().extension() == ".toml") found.push_back(entry.path().stem().string());
  }
  std::sort(found.begin(), found.end());
  for (const std::string& name : found) names.push_back(name);
  return names;
}

}  // namespace

bool is_image(const fs::path& path) {
  const std::string extension = io::extension_of(path);
  return extension == ".nii" || extension == ".nii.gz" || extension == ".nrrd" ||
         extension == ".mha" || extension == ".mhd";
}

CaseFolder::CaseFolder(const fs::path& folder) {
  std::error_code error;
  folder_ = fs::canonical(folder, error);
  if (error || !fs::is_directory(folder_))
    fail(coxa::ErrorCode::bad_file, folder.string(), " is not a folder");
}

bool CaseFolder::has_meshes() const {
  return fs::exists(folder_ / "mesh/acetabular_cartilage.vtu") &&
         fs::exists(folder_ / "mesh/femoral_cartilage.vtu");
}

CaseInput CaseFolder::input() const {
  CaseInput input;
  std::vector<fs::path> files{folder_ / "subject.toml"};
  if (fs::exists(folder_ / "manifest.json")) {
    // the copy in a result folder names its files relative to where the original lies
    const Json manifest = read_json(folder_ / "manifest.json");
    if (manifest.contains("subject_file"))
      files.insert(files.begin(), fs::path(manifest["subject_file"].get<std::string>()));
  }
  for (const fs::path& file : files) {
    if (!fs::exists(file)) continue;
    try {
      input.subject = pipeline::read_subject(file);
      input.images = input.subject->images;
      input.side = input.subject->side;
      input.fault.clear();
      return input;
    } catch (const Error& error) {
      input.fault = error.what();
    }
  }
  std::vector<fs::path> images;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    if (entry.is_regular_file() && is_image(entry.path())) images.push_back(entry.path());
  }
  if (images.size() == 1) {
    input.images = {{images.front(), std::nullopt}};
    input.fault.clear();
  } else if (input.fault.empty()) {
    input.fault = join_text("the folder has no subject.toml, and ", images.size(), " images");
  }
  return input;
}

fs::path CaseFolder::landmarks_file() const {
  const fs::path own = folder_ / "landmarks.mrk.json";
  if (fs::exists(own)) return own;
  const CaseInput in = input();
  return in.subject ? in.subject->landmarks : fs::path();
}

fs::path CaseFolder::pins_file() const {
  const fs::path own = folder_ / "pins.mrk.json";
  if (fs::exists(own)) return own;
  const CaseInput in = input();
  return in.subject ? in.subject->pins : fs::path();
}

Side CaseFolder::side() const {
  const fs::path file = folder_ / "subject.toml";
  require(fs::exists(file), folder_.string(), " has no subject.toml, so its side is not known");
  return pipeline::read_side(io::Table::read(file));
}

pipeline::JointRequest CaseFolder::joint_request() const {
  const fs::path joint_file = folder_ / "joint/joint.toml";
  if (fs::exists(joint_file)) return pipeline::read_joint_request(joint_file);
  const io::Table subject = io::Table::read(folder_ / "subject.toml");
  pipeline::JointRequest request{
      pipeline::read_side(subject),           folder_ / "mesh/acetabular_cartilage.vtu",
      folder_ / "mesh/femoral_cartilage.vtu", folder_ / "segment/hip_bone.vtp",
      folder_ / "segment/femur.vtp",          folder_ / "motion",
      pipeline::read_joint_entry(subject)};
  request.labrum = surface_file(kLabrum);
  return request;
}

fs::path CaseFolder::surface_file(const std::string& structure) const {
  const fs::path segmented = folder_ / "segment" / (structure + ".vtp");
  if (fs::exists(segmented)) return segmented;
  const fs::path joint_file = folder_ / "joint/joint.toml";
  if (structure != kLabrum || !fs::exists(joint_file)) return {};
  return pipeline::read_joint_request(joint_file).labrum;
}

CaseFolder::Hip CaseFolder::read_hip() const {
  require(has_meshes() && fs::exists(folder_ / "motion/frames.json"),
          "the live examination needs the meshes and the joint centre: run the chain first");
  const pipeline::JointRequest request = joint_request();
  const auto artefacts = pipeline::read_motion_artefacts(request.motion, request.side);
  Hip hip{pipeline::read_joint_model(request, artefacts.frames), {}};
  hip.load = pipeline::joint_load(request, hip.model);
  return hip;
}

Json CaseFolder::joint_frames() const {
  joint::JointModel model;
  model.side = side();
  model.acetabular_cartilage = io::read_tets(folder_ / "mesh/acetabular_cartilage.vtu");
  const auto artefacts = pipeline::read_motion_artefacts(folder_ / "motion", model.side);
  model.X_IP = artefacts.frames.pelvis.X_IB;
  model.X_IF = artefacts.frames.femur.X_IB;
  const ClockFace face = joint::socket_clock(model);
  const motion::HipAngles image =
      motion::angles_from_rotation(model.X_IP.R.transpose() * model.X_IF.R, model.side);
  return {{"clock",
           {{"centre", json_of(face.centre)},
            {"axis", json_of(face.axis)},
            {"twelve", json_of(face.twelve)},
            {"three", json_of(face.three)}}},
          {"image_pose",
           {{"flexion_deg", degrees(image.flexion)},
            {"adduction_deg", degrees(image.adduction)},
            {"internal_rotation_deg", degrees(image.internal_rotation)}}}};
}

Json CaseFolder::overview() const {
  Json json{{"folder", folder_.filename().string()},
            {"coxa_version", pipeline::version()},
            {"fields", field_list()},
            {"movements", movement_list()},
            {"surfaces", Json::array()},
            {"bodies", Json::array()}};
  for (const char* name : kStructures) {
    if (!surface_file(name).empty()) json["surfaces"].push_back(name);
  }
  if (has_meshes()) json["bodies"] = {"acetabular", "femoral"};
  const CaseInput in = input();
  json["name"] = in.subject ? in.subject->name : folder_.filename().string();
  if (in.side) json["side"] = *in.side == Side::left ? "left" : "right";
  json["image"] = in.images.empty() ? Json(nullptr) : Json(in.images.front().path.filename());
  json["image_fault"] = in.fault;
  json["can_run"] = in.subject.has_value();
  if (in.subject) json["movement"] = in.subject->motion.pattern;
  json["normal_curves"] = normal_curves();
  const bool framed = has_meshes() && fs::exists(folder_ / "motion/frames.json") &&
                      fs::exists(folder_ / "subject.toml");
  json["live"] = framed;
  if (framed) json.update(joint_frames());
  if (fs::exists(folder_ / "joint/summary.csv"))
    json["summary"] = csv_table(folder_ / "joint/summary.csv");
  if (fs::exists(folder_ / "motion/motion.csv"))
    json["motion"] = csv_table(folder_ / "motion/motion.csv");
  if (fs::exists(folder_ / "manifest.json"))
    json["stages"] = read_json(folder_ / "manifest.json").value("stages", Json::array());
  if (fs::exists(folder_ / "report/report.html")) json["report"] = "/files/report/report.html";
  return json;
}

std::string CaseFolder::surface(const std::string& structure) const {
  const bool known = std::count(std::begin(kStructures), std::end(kStructures), structure) > 0;
  require(known, "there is no structure \"", structure, "\"");
  const fs::path file = surface_file(structure);
  if (file.empty())
    fail(coxa::ErrorCode::bad_file, "there is no surface of the ", structure, " yet");
  const Surface surface = io::read_surface_with_fields(file);
  Bundle bundle(Json{{"name", structure}}.dump());
  bundle.add("positions", surface.mesh.points);
  bundle.add("triangles", surface.mesh.triangles);
  for (const auto& [name, values] : surface.fields) bundle.add(name, MatX(values));
  return bundle.bytes();
}

std::shared_ptr<const Body> CaseFolder::read_body(const std::string& name) const {
  require(name == "acetabular" || name == "femoral", "there is no body \"", name, "\"");
  const fs::path file = folder_ / "mesh" / (name + "_cartilage.vtu");
  std::error_code error;
  const auto written = fs::last_write_time(file, error);  // a missing file is told of on reading
  KeptBody& kept = bodies_[name];
  if (!kept.body || kept.written != written) {
    Body body{name, io::read_tets(file), {}};
    body.surface = body_surface(body.mesh);
    kept = {written, std::make_shared<const Body>(std::move(body))};
  }
  return kept.body;
}

std::string CaseFolder::body(const std::string& name) const {
  const auto body = read_body(name);
  Bundle bundle(Json{{"name", name}, {"tets", body->mesh.n_tets()}}.dump());
  bundle.add("positions", at_surface(body->surface, body->mesh.points));
  bundle.add("triangles", body->surface.triangles);
  bundle.add("tags", body->surface.tags);
  bundle.add("thickness", MatX(surface_thickness(body->mesh, body->surface)));
  return bundle.bytes();
}

RigidTransform CaseFolder::unsolved_pose(Index index) const {
  const auto artefacts = pipeline::read_motion_artefacts(folder_ / "motion", side());
  require(index < artefacts.motion.n_frames(), "there is no frame ", index);
  return artefacts.frames.pelvis.X_IB * artefacts.motion.X_PF[static_cast<std::size_t>(index)] *
         artefacts.frames.femur.X_IB.inverse();
}

std::string CaseFolder::frame(Index index) const {
  const fs::path frames = folder_ / "joint/frames";
  require(index >= 0, "there is no frame ", index);
  if (!has_stored_frame(frames, index))  // without a result: the pose alone
    return Bundle(Json{{"frame", index}, {"femur_pose", json_of(unsolved_pose(index))}}.dump())
        .bytes();
  return stored_frame(frames, index, {read_body("acetabular"), read_body("femoral")});
}

}  // namespace coxa::serve
