#include "stored_frame.h"

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/io/tets.h>
#include <coxa/serve/bundle.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "pose_json.h"

namespace coxa::serve {
namespace fs = std::filesystem;
namespace {

std::string frame_file(const std::string& part, Index index) {
  char name[40];
  std::snprintf(name, sizeof name, "%s_%04d.vtu", part.c_str(), static_cast<int>(index));
  return name;
}

/// Nodal values of one body at one frame, from what the joint stage wrote.
std::map<std::string, VecX> stored_fields(const io::TetFile& file) {
  joint::StressFields fields;
  const MatX& nine = file.fields.at_tets.at("green_strain");
  fields.green_strain.resize(nine.rows(), 6);
  constexpr int kPlace[6] = {0, 4, 8, 1, 5, 2};  // xx yy zz xy yz zx of a full tensor by rows
  for (int c = 0; c < 6; ++c) fields.green_strain.col(c) = nine.col(kPlace[c]);
  fields.principal_stress = file.fields.at_tets.at("principal_stress_MPa");
  fields.principal_strain = file.fields.at_tets.at("principal_strain");
  fields.von_mises = file.fields.at_tets.at("von_mises_MPa");
  auto values = nodal_fields(file.mesh, fields);
  values["contact_pressure"] = file.fields.at_points.at("contact_pressure_MPa");
  if (const auto gap = file.fields.at_points.find("gap_mm"); gap != file.fields.at_points.end())
    values["gap"] = gap->second;
  return values;
}

}  // namespace

bool has_stored_frame(const fs::path& frames, Index index) {
  return fs::exists(frames / frame_file("femoral", index));
}

std::string stored_frame(const fs::path& frames, Index index,
                         const std::vector<std::shared_ptr<const Body>>& bodies) {
  RigidTransform X_II;
  std::vector<std::pair<std::string, MatX>> arrays;
  for (const auto& body : bodies) {
    const io::TetFile file = io::read_tets_with_fields(frames / frame_file(body->name, index));
    require(file.mesh.n_vertices() == body->mesh.n_vertices(), "frame ", index, " has ",
            file.mesh.n_vertices(), " nodes, the mesh ", body->mesh.n_vertices(),
            ": they are of different runs");
    if (body->name == "femoral") {
      // the displacement counts from the femur's rigid pose, which is thus exact here
      const Points rigid = file.mesh.points - Points(file.fields.at_points.at("displacement_mm"));
      X_II = fit_rigid(body->mesh.points, rigid);
    }
    arrays.emplace_back(body->name + ".positions", at_surface(body->surface, file.mesh.points));
    for (const auto& [key, values] : stored_fields(file))
      arrays.emplace_back(body->name + "." + key, at_surface(body->surface, values));
  }
  const nlohmann::json header{{"frame", index}, {"femur_pose", json_of(X_II)}};
  Bundle bundle(header.dump());
  for (const auto& [key, values] : arrays) bundle.add(key, values);
  return bundle.bytes();
}

}  // namespace coxa::serve
