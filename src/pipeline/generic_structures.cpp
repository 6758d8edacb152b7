#include "generic_structures.h"

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/mesh/mirrored.h>
#include <coxa/pipeline/structures.h>
#include <coxa/segment/part_bodies.h>
#include <coxa/shape/build_atlas.h>
#include <coxa/shape/carve.h>
#include <coxa/shape/labrum.h>
#include <coxa/shape/ligaments.h>

#include <algorithm>

namespace coxa::pipeline {
namespace {

// mm about the head's centre in the atlas: what places the neck and the head in a femur
constexpr double kNearHead = 60.0;
// mm, of what is generic in bone or cartilage, above which the user is told
constexpr double kToleratedDepth = 0.05;

constexpr const char* kHosts[] = {"hip_bone", "acetabular_cartilage", "femur", "femoral_cartilage"};

/// A right hip's surfaces by name.
class RightHip {
 public:
  RightHip(const SurfaceSet& surfaces, Side side) : side_(side) {
    for (const char* name : kHosts) {
      const auto found = surfaces.find(name);
      require(found != surfaces.end(), "labrum and ligaments need the surface of the ", name);
      meshes_[name] = turned(found->second.mesh);
    }
  }
  const TriMesh& operator[](const std::string& name) const { return meshes_.at(name); }
  std::vector<TriMesh> head() const {
    return {meshes_.at("femur"), meshes_.at("femoral_cartilage")};
  }
  /// To the right side, or back.
  TriMesh turned(const TriMesh& mesh) const { return side_ == Side::left ? mirrored(mesh) : mesh; }

 private:
  Side side_;
  std::map<std::string, TriMesh> meshes_;
};

/// Carried from the atlas' mean femur, whose vertices the femur's are.
shape::FemurMarks carried_marks(const shape::StructureModel& model, const shape::Landmarks& mean,
                                const TriMesh& femur) {
  const Points from = dual_surface(model.hierarchy.levels.back()).points;
  std::vector<Index> rows;
  for (Index v = 0; v < static_cast<Index>(from.rows()); ++v) {
    if (from.row(v).norm() < kNearHead) rows.push_back(v);
  }
  const Similarity pose = fit_similarity(from(rows, Eigen::all), femur.points(rows, Eigen::all));
  const auto inside = [&](const char* name) -> Vec3 {
    return pose.X * (pose.scale * mean.at(name));
  };
  // a finest vertex of the simplex mesh is a triangle of the surface
  const auto on = [&](const char* name) -> Vec3 {
    const auto corners = femur.triangles.row(model.landmark_vertices.at(name));
    return (femur.points.row(corners[0]) + femur.points.row(corners[1]) +
            femur.points.row(corners[2])) /
           3.0;
  };
  return {inside("femoral_head_centre"), inside("femoral_neck_centre"),
          on("greater_trochanter_tip"), on("lesser_trochanter_tip")};
}

/// Found on the femur itself, about the socket's centre.
shape::FemurMarks found_marks(TriMesh femur, const Vec3& centre) {
  femur.points.rowwise() -= centre.transpose();
  const shape::Landmarks marks = shape::find_landmarks({{"femur", std::move(femur)}});
  const auto at = [&](const char* name) -> Vec3 {
    const auto found = marks.find(name);
    require(found != marks.end(), "the femur shows no ", name);
    return found->second + centre;
  };
  return {at("femoral_head_centre"), at("femoral_neck_centre"), at("greater_trochanter_tip"),
          at("lesser_trochanter_tip")};
}

shape::FemurMarks marks_of(const TriMesh& femur, const Vec3& centre, const shape::Atlas* atlas) {
  if (atlas == nullptr) return found_marks(femur, centre);
  const shape::StructureModel& model = shape::structure(*atlas, "femur");
  const bool same = model.hierarchy.levels.back().n_vertices() == femur.n_triangles() &&
                    model.landmark_vertices.contains("greater_trochanter_tip") &&
                    model.landmark_vertices.contains("lesser_trochanter_tip");
  return same ? carried_marks(model, atlas->landmarks, femur) : found_marks(femur, centre);
}

Surface generic_surface(TriMesh mesh) {
  Surface surface;
  const Index n = mesh.n_vertices();
  surface.mesh = std::move(mesh);
  surface.fields["generic"] = VecX::Ones(n);
  surface.fields["completed"] = VecX::Ones(n);
  surface.fields["confidence"] = VecX::Zero(n);
  return surface;
}

/// Makes them one after another, each kept out of those before.
class Maker {
 public:
  Maker(const RightHip& hip, const std::vector<std::string>& wanted, const shape::Atlas* atlas)
      : hip_(hip), wanted_(wanted), atlas_(atlas) {
    for (const char* name : kHosts) firm_.push_back(hip[name]);
  }

  /// What was made, and why others were not.
  std::map<std::string, TriMesh> made;
  std::vector<std::string> failures;

  /// Takes everything out of bones, cartilages and what was taken out before. @returns the depth
  /// that is left, mm
  double parted() {
    std::vector<const TriMesh*> hosts;
    for (const char* name : kHosts) hosts.push_back(&hip_[name]);
    std::vector<const TriMesh*> all = hosts;
    double deepest = 0.0;
    for (auto& [name, mesh] : made) {
      // a band that crosses others would be cut through: it stays in them, but in no bone
      const bool out_of_all = carve(mesh, all);
      if (!out_of_all && !carve(mesh, hosts))
        failures.push_back(name + " lies in bone or cartilage for the most part");
      deepest = std::max(deepest, segment::update_parted({{&mesh}}, out_of_all ? all : hosts));
      all.push_back(&mesh);
    }
    return deepest;
  }

  void all(const Monitor& monitor) {
    const shape::SocketRim rim =
        shape::find_socket_rim(hip_["hip_bone"], hip_["acetabular_cartilage"]);
    attempt("acetabular_labrum", [&] {
      return shape::make_labrum(rim, hip_["hip_bone"], hip_["acetabular_cartilage"], hip_.head());
    });
    attempt("transverse_acetabular_ligament", [&] {
      return shape::make_transverse_ligament(rim, hip_["hip_bone"], hip_["acetabular_cartilage"],
                                             hip_.head());
    });
    const auto& names = shape::generic_ligament_names();
    if (std::none_of(names.begin(), names.end(), [&](const auto& name) { return is_wanted(name); }))
      return;
    const shape::FemurMarks marks = marks_of(hip_["femur"], rim.clock.centre, atlas_);
    for (const auto& site :
         shape::find_ligament_sites(rim, hip_["hip_bone"], hip_["femur"], marks)) {
      monitor.check_cancelled();
      attempt(site.name, [&] { return shape::make_ligament(site, marks.head_centre, firm_); });
    }
  }

 private:
  /// @returns whether enough is left
  static bool carve(TriMesh& mesh, const std::vector<const TriMesh*>& obstacles) {
    try {
      mesh = shape::carved(mesh, obstacles);
      return true;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::below_quality) throw;
      return false;
    }
  }
  bool is_wanted(const std::string& name) const {
    return std::find(wanted_.begin(), wanted_.end(), name) != wanted_.end();
  }
  // all of them, so that each lies as it does beside the others, whichever are wanted
  template <class Make>
  void attempt(const std::string& name, const Make& make) {
    try {
      firm_.push_back(make());
      if (is_wanted(name)) made[name] = firm_.back();
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled) throw;
      if (is_wanted(name)) failures.push_back(name + " was not made: " + error.what());
    }
  }

  const RightHip& hip_;
  const std::vector<std::string>& wanted_;
  const shape::Atlas* atlas_;
  std::vector<TriMesh> firm_;
};

void warn(const std::string& text, Record& record, const Monitor& monitor) {
  record.warnings.push_back(text);
  monitor.warn(text);
}

}  // namespace

std::vector<std::string> generic_among(const std::vector<std::string>& wanted) {
  std::vector<std::string> names;
  std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(names), is_generic);
  return names;
}

void add_generic(SurfaceSet& surfaces, const std::vector<std::string>& wanted, Side side,
                 const shape::Atlas* atlas, Record& record, const Monitor& monitor) {
  const std::vector<std::string> names = generic_among(wanted);
  if (names.empty()) return;
  const RightHip hip(surfaces, side);
  Maker maker(hip, names, atlas);
  try {
    maker.all(monitor);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    maker.failures.push_back(join_text("labrum and ligaments were not all made: ", error.what()));
  }
  const double depth = maker.parted();
  if (depth > kToleratedDepth)
    maker.failures.push_back(join_text(
        "labrum or ligaments enter bone, cartilage or each other by up to ", depth, " mm"));
  std::string list;
  for (const auto& [name, mesh] : maker.made) {
    surfaces[name] = generic_surface(hip.turned(mesh));
    record.figures[name + "_generic"] = std::int64_t{1};
    list += (list.empty() ? "" : ", ") + name;
  }
  for (const std::string& text : maker.failures) warn(text, record, monitor);
  if (!list.empty())
    warn(list + ": generic, made on the bones by published measures; no image shows them", record,
         monitor);
}

}  // namespace coxa::pipeline
