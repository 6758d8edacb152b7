#include "live_answer.h"

#include "pose_json.h"

#include <algorithm>

namespace coxa::serve {
namespace {
using Json = nlohmann::json;
using Values = std::map<std::string, VecX>;

Json json_of(const std::optional<joint::LiveHip::NearPlace>& near) {
  if (!near) return nullptr;
  const Vec3& p = near->point;
  return {
      {"clearance_mm", near->clearance}, {"place", {p.x(), p.y(), p.z()}}, {"hour", near->hour}};
}

/// True where a field comes of stress or strain; an empty one stands for all.
bool needs_elements(const std::string& field) {
  if (field.empty()) return true;
  if (field == "contact_pressure" || field == "gap") return false;
  return std::any_of(kFrameFields.begin(), kFrameFields.end(),
                     [&](const FieldName& known) { return known.key == field; });
}
/// Values that are drawn: of one field, or all of them for an empty name.
Values drawn(Values values, const std::string& field) {
  if (!field.empty())
    std::erase_if(values, [&](const auto& entry) { return entry.first != field; });
  return values;
}

void add_body(Bundle& bundle, const std::string& name, const BodySurface& surface,
              const Points& positions, const Values& values) {
  bundle.add_in_steps(name + ".positions", at_surface(surface, positions));
  for (const auto& [key, value] : values)
    bundle.add_in_steps(name + "." + key, at_surface(surface, value));
}

double largest_move(const Points& a, const Points& b) {
  return (a - b).rowwise().norm().maxCoeff();
}

}  // namespace

Json live_meta(const joint::LiveHip::Step& step, const motion::HipAngles& angles) {
  const joint::FrameResult& frame = step.frame;
  const joint::ContactFigures& contact = frame.contact;
  Json meta{{"status", joint::name_of(frame.status)},
            {"reason", frame.reason},
            {"femur_pose", json_of(frame.X_II)},
            {"flexion_deg", degrees(angles.flexion)},
            {"adduction_deg", degrees(angles.adduction)},
            {"internal_rotation_deg", degrees(angles.internal_rotation)},
            {"bone", json_of(step.bone)},
            {"labrum", json_of(step.labrum)},
            {"residual", frame.residual},
            {"iterations", frame.iterations}};
  if (frame.status == joint::FrameStatus::converged) {
    meta["peak_pressure_p99_MPa"] = contact.peak_pressure_p99;
    meta["mean_pressure_MPa"] = contact.mean_pressure;
    meta["contact_area_mm2"] = contact.contact_area;
    meta["contact_area_percent"] = 100.0 * contact.contact_share;
    meta["penetration_mm"] = contact.penetration;
  }
  return meta;
}

Json live_error(const joint::FrameResult& exact, const joint::FrameResult& step) {
  return {{"live_peak_pressure_p99_MPa", step.contact.peak_pressure_p99},
          {"live_contact_area_mm2", step.contact.contact_area},
          {"largest_move_mm",
           std::max(largest_move(exact.acetabular_displacement, step.acetabular_displacement),
                    largest_move(exact.femoral_displacement, step.femoral_displacement))}};
}

void add_live_state(Bundle& bundle, const joint::JointModel& model, const LiveSurfaces& surfaces,
                    const joint::FrameResult& frame, const std::string& field) {
  Values acetabular{{"contact_pressure", frame.acetabular_pressure}, {"gap", frame.acetabular_gap}};
  Values femoral{{"contact_pressure", frame.femoral_pressure}};
  if (needs_elements(field)) {
    acetabular.merge(nodal_fields(model.acetabular_cartilage, acetabular_fields(model, frame)));
    femoral.merge(nodal_fields(model.femoral_cartilage, femoral_fields(model, frame)));
  }
  add_body(bundle, "acetabular", surfaces.acetabular,
           model.acetabular_cartilage.points + frame.acetabular_displacement,
           drawn(std::move(acetabular), field));
  add_body(bundle, "femoral", surfaces.femoral,
           transformed(model.femoral_cartilage.points, frame.X_II) + frame.femoral_displacement,
           drawn(std::move(femoral), field));
}

}  // namespace coxa::serve
