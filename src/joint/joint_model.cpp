#include <coxa/joint/joint_model.h>

#include <coxa/core/error.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/vertex_normals.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "labrum_body.h"

namespace coxa::joint {
namespace {

// the frames share the joint centre; more than this apart they are mistaken for something else, mm
constexpr double kCentreSlack = 0.5;

void check_cartilage(const TetMesh& mesh, const char* what) {
  if (mesh.n_tets() == 0) fail(ErrorCode::bad_mesh, what, " has no tetrahedra");
  if (mesh.facet_tags.size() != static_cast<std::size_t>(mesh.facets.rows())) {
    fail(ErrorCode::bad_mesh, what, " has ", mesh.facets.rows(), " boundary facets and ",
         mesh.facet_tags.size(), " tags");
  }
  if (mesh.mid_nodes.rows() != 0) {
    fail(ErrorCode::bad_mesh, what, " has ten-node elements; the joint takes four-node ones");
  }
  for (const auto& [tag, side] : {std::pair{FacetTag::articular_side, "articular_side"},
                                  std::pair{FacetTag::bone_side, "bone_side"}}) {
    if (facets_with(mesh, tag).rows() == 0) {
      fail(ErrorCode::bad_mesh, what, " has no boundary facet tagged ", side);
    }
  }
}

/// Share of the articular surface's normals that point away from the joint centre, by area, in [-1,
/// 1].
double outwardness(const TetMesh& mesh, const Vec3& centre) {
  const TriMesh articular{mesh.points, facets_with(mesh, FacetTag::articular_side)};
  const Points normals = triangle_normals(articular);
  const VecX areas = triangle_areas(articular);
  double sum = 0.0;
  for (Index f = 0; f < articular.n_triangles(); ++f) {
    const Vec3 middle = articular.points(articular.triangles.row(f), Eigen::all).colwise().mean();
    sum += areas[f] * ((middle - centre).dot(normals.row(f)) > 0.0 ? 1.0 : -1.0);
  }
  return sum / areas.sum();
}

void check_ligaments(const JointModel& model) {
  std::set<std::string> names;
  for (const Ligament& ligament : model.ligaments) {
    const std::string& name = ligament.name;
    const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
    require(!name.empty() && std::all_of(name.begin(), name.end(), plain),
            "the name of a ligament takes letters, digits and underscores, got \"", name, "\"");
    require(names.insert(name).second, "two ligaments are called ", name);
    require(ligament.stiffness > 0.0, name, ": stiffness must be positive, got ",
            ligament.stiffness, " N/mm");
    require(ligament.slack_length > 0.0, name, ": slack length must be positive, got ",
            ligament.slack_length, " mm");
    require(ligament.wrap_radius >= 0.0, name,
            ": the radius it wraps around must not be negative, ", "got ", ligament.wrap_radius,
            " mm");
    require((ligament.origin - ligament.insertion).norm() > 0.0, name,
            ": origin and insertion are one point");
    const Vec3& centre = model.X_IF.p;
    const double nearest =
        std::min((ligament.origin - centre).norm(), (ligament.insertion - centre).norm());
    require(ligament.wrap_radius == 0.0 || ligament.wrap_radius < nearest, name, ": an end lies ",
            nearest, " mm from the joint centre, inside the sphere of ", ligament.wrap_radius,
            " mm that it wraps around");
  }
}

void check_material(const CartilageMaterial& material) {
  require(material.youngs_modulus > 0.0, "Young's modulus must be positive, got ",
          material.youngs_modulus, " MPa");
  const bool by_patches = material.volume_change == VolumeChange::by_patches;
  const double least_ratio = by_patches ? 0.0 : -1.0;
  require(least_ratio < material.poissons_ratio && material.poissons_ratio < 0.5,
          "Poisson's ratio must be in (", least_ratio, ", 0.5), got ", material.poissons_ratio);
}

void check_labrum(const JointModel& model) {
  const TetMesh& mesh = model.labrum_body;
  if (mesh.n_tets() == 0) return;
  check_material(model.labrum_material);
  if (mesh.mid_nodes.rows() != 0)
    fail(ErrorCode::bad_mesh, "the labrum has ten-node elements; the joint takes four-node ones");
  if (mesh.facets.rows() == 0) fail(ErrorCode::bad_mesh, "the labrum has no boundary facets");
  const std::size_t held = labrum_seat(model).size();
  if (held < 3) {
    fail(ErrorCode::bad_mesh, "nothing holds the labrum: ", held,
         " nodes are on facets tagged bone_side or lie on the hip bone");
  }
}

}  // namespace

void check_model(const JointModel& model) {
  check_cartilage(model.acetabular_cartilage, "acetabular cartilage");
  check_cartilage(model.femoral_cartilage, "femoral cartilage");
  check_material(model.material);
  const double apart = (model.X_IP.p - model.X_IF.p).norm();
  require(apart <= kCentreSlack,
          "pelvis and femur frames must both have their origin at the joint ",
          "centre in the image pose; they are ", apart, " mm apart, limit ", kCentreSlack, " mm");
  if (outwardness(model.acetabular_cartilage, model.X_IP.p) > 0.0) {
    fail(ErrorCode::bad_mesh,
         "the acetabular cartilage's articular side faces away from the joint centre: ",
         "articular_side and bone_side look exchanged");
  }
  if (outwardness(model.femoral_cartilage, model.X_IF.p) < 0.0) {
    fail(ErrorCode::bad_mesh, "the femoral cartilage's articular side faces the joint centre: ",
         "articular_side and bone_side look exchanged");
  }
  require(model.friction >= 0.0, "the coefficient of friction must not be negative, got ",
          model.friction);
  require(model.hip_bone.empty() == model.femur.empty(),
          "the bony limit needs both bone surfaces, or none");
  require(model.labrum.empty() || !model.femur.empty(),
          "contact of the femur with the labrum needs both bone surfaces");
  require(model.bare_bone == BareBone::hip_bone || !model.femur.empty(),
          "acetabular cartilage on bare femur needs both bone surfaces");
  check_ligaments(model);
  check_labrum(model);
  if (!model.femur.empty()) {
    require_closed_manifold(model.hip_bone, "hip_bone");
    require_closed_manifold(model.femur, "femur");
    if (!model.labrum.empty()) require_closed_manifold(model.labrum, "labrum");
  }
}

Triangles facets_with(const TetMesh& mesh, FacetTag tag) {
  const auto count = std::count(mesh.facet_tags.begin(), mesh.facet_tags.end(), tag);
  Triangles chosen(count, 3);
  Index row = 0;
  for (Index f = 0; f < mesh.facets.rows(); ++f) {
    if (mesh.facet_tags[static_cast<std::size_t>(f)] == tag) chosen.row(row++) = mesh.facets.row(f);
  }
  return chosen;
}

Vec3 socket_axis(const JointModel& model) {
  const TriMesh articular{model.acetabular_cartilage.points,
                          facets_with(model.acetabular_cartilage, FacetTag::articular_side)};
  return (triangle_normals(articular).transpose() * triangle_areas(articular)).normalized();
}

ClockFace socket_clock(const JointModel& model) {
  return make_clock_face(model.X_IP.p, socket_axis(model), model.X_IP.R.col(1),
                         model.X_IP.R.col(0));
}

}  // namespace coxa::joint
