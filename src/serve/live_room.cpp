#include "live_room.h"

#include "pose_json.h"

#include <coxa/core/error.h>
#include <coxa/serve/bundle.h>

#include <boost/asio/post.hpp>
#include <chrono>

namespace coxa::serve {
namespace {
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxGuests = 4;  // each holds a hip of its own

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Json number_or_null(double value) { return value == value ? Json(value) : Json(nullptr); }

Json meta_of(const joint::FrameResult& frame, const motion::HipAngles& angles) {
  const joint::ContactFigures& contact = frame.contact;
  Json meta{{"status", joint::name_of(frame.status)},
            {"reason", frame.reason},
            {"femur_pose", json_of(frame.X_II)},
            {"flexion_deg", degrees(angles.flexion)},
            {"adduction_deg", degrees(angles.adduction)},
            {"internal_rotation_deg", degrees(angles.internal_rotation)},
            {"bone_clearance_mm", number_or_null(frame.bone_clearance)},
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

using Arrays = std::vector<std::pair<std::string, MatX>>;
using Values = std::map<std::string, VecX>;

void add_body(Arrays& arrays, const std::string& name, const BodySurface& surface,
              const Points& positions, const Values& values) {
  arrays.emplace_back(name + ".positions", at_surface(surface, positions));
  for (const auto& [key, value] : values)
    arrays.emplace_back(name + "." + key, at_surface(surface, value));
}

/// True where a field comes of stress or strain; an empty one stands for all.
bool needs_elements(const std::string& field) {
  return field != "contact_pressure" && field != "gap" && field != "thickness";
}
Values chosen(Values values, const std::string& field) {
  if (!field.empty())
    std::erase_if(values, [&](const auto& entry) { return entry.first != field; });
  return values;
}
Values acetabular_values(const joint::JointModel& model, const joint::FrameResult& frame,
                         const std::string& field) {
  Values values;
  if (needs_elements(field))
    values =
        chosen(nodal_fields(model.acetabular_cartilage, acetabular_fields(model, frame)), field);
  values["contact_pressure"] = frame.acetabular_pressure;
  values["gap"] = frame.acetabular_gap;
  return values;
}
Values femoral_values(const joint::JointModel& model, const joint::FrameResult& frame,
                      const std::string& field) {
  Values values;
  if (needs_elements(field))
    values = chosen(nodal_fields(model.femoral_cartilage, femoral_fields(model, frame)), field);
  values["contact_pressure"] = frame.femoral_pressure;
  return values;
}

}  // namespace

/// One connection's hip. `hip` and what belongs to it are touched by the solver's thread alone; the
/// rest is guarded by the room's mutex.
struct LiveRoom::Guest {
  ClientId client = 0;
  std::optional<Question> question;
  bool working = false;
  std::atomic<bool> interrupt{false};  ///< ends a settling that is no longer wanted

  CaseFolder::Hip source;
  std::map<std::string, BodySurface> surfaces;
  std::unique_ptr<joint::LiveHip> hip;
  std::optional<joint::FrameResult> last;  ///< the last step, to compare the exact state with
};

LiveRoom::~LiveRoom() {
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [client, guest] : guests_) guest->question.reset(), guest->interrupt = true;
  }
  thread_.join();
}

void LiveRoom::pose(ClientId client, std::int64_t number, const motion::HipAngles& target,
                    const std::string& field) {
  ask(client, {number, false, target, field});
}

void LiveRoom::settle(ClientId client, std::int64_t number) { ask(client, {number, true, {}, ""}); }

void LiveRoom::leave(ClientId client) {
  const std::lock_guard lock(mutex_);
  const auto it = guests_.find(client);
  if (it == guests_.end()) return;
  it->second->question.reset();
  it->second->interrupt = true;
  guests_.erase(it);
}

void LiveRoom::ask(ClientId client, const Question& question) {
  const std::lock_guard lock(mutex_);
  auto it = guests_.find(client);
  if (it == guests_.end()) {
    if (guests_.size() >= kMaxGuests) {
      return send_text(client, {{"type", "live_error"},
                                {"number", question.number},
                                {"text", "four examinations are open already; close one"}});
    }
    it = guests_.emplace(client, std::make_shared<Guest>()).first;
    it->second->client = client;
  }
  const std::shared_ptr<Guest>& guest = it->second;
  guest->question = question;
  guest->interrupt = true;
  if (guest->working) return;
  guest->working = true;
  boost::asio::post(thread_, [this, guest] { work(guest); });
}

void LiveRoom::work(const std::shared_ptr<Guest>& guest) {
  Question question;
  {
    const std::lock_guard lock(mutex_);
    if (!guest->question) {
      guest->working = false;
      return;
    }
    question = *guest->question;
    guest->question.reset();
    guest->interrupt = false;
  }
  try {
    answer(*guest, question);
  } catch (const Error& error) {
    const bool cancelled = error.code() == coxa::ErrorCode::cancelled;
    send_text(guest->client, {{"type", cancelled ? "live_broken_off" : "live_error"},
                              {"number", question.number},
                              {"text", error.what()}});
  } catch (const std::exception& error) {
    send_text(guest->client, {{"type", "live_error"},
                              {"number", question.number},
                              {"text", std::string("internal error: ") + error.what()}});
  }
  // the others' questions come before the next one of this guest
  boost::asio::post(thread_, [this, guest] { work(guest); });
}

void LiveRoom::answer(Guest& guest, const Question& question) {
  if (!guest.hip) {
    guest.source = folder_.read_hip();
    guest.surfaces["acetabular"] = body_surface(guest.source.model.acetabular_cartilage);
    guest.surfaces["femoral"] = body_surface(guest.source.model.femoral_cartilage);
    guest.hip = std::make_unique<joint::LiveHip>(guest.source.model, guest.source.load);
  }
  Monitor monitor;
  if (question.exact) monitor.cancel_flag = &guest.interrupt;

  const auto start = Clock::now();
  joint::LiveHip::Step step;
  if (question.exact) {
    step.frame = guest.hip->settle(monitor);
  } else {
    step = guest.hip->step_towards(question.target, monitor);
  }
  const double solved = milliseconds_since(start);
  const auto packing = Clock::now();
  const joint::FrameResult& frame = step.frame;
  Json meta = meta_of(frame, guest.hip->angles());
  meta["type"] = question.exact ? "settled" : "step";
  meta["number"] = question.number;
  meta["arrived"] = step.arrived;
  meta["solver_ms"] = solved;

  Arrays arrays;
  if (frame.status == joint::FrameStatus::converged) {
    const joint::JointModel& model = guest.source.model;
    add_body(arrays, "acetabular", guest.surfaces["acetabular"],
             model.acetabular_cartilage.points + frame.acetabular_displacement,
             acetabular_values(model, frame, question.field));
    add_body(arrays, "femoral", guest.surfaces["femoral"],
             transformed(model.femoral_cartilage.points, frame.X_II) + frame.femoral_displacement,
             femoral_values(model, frame, question.field));
    meta["tets"] = model.acetabular_cartilage.n_tets() + model.femoral_cartilage.n_tets();
    if (question.exact && guest.last) {
      const auto moved = [](const Points& a, const Points& b) {
        return (a - b).rowwise().norm().maxCoeff();
      };
      meta["live_peak_pressure_p99_MPa"] = guest.last->contact.peak_pressure_p99;
      meta["live_contact_area_mm2"] = guest.last->contact.contact_area;
      meta["largest_move_mm"] =
          std::max(moved(frame.acetabular_displacement, guest.last->acetabular_displacement),
                   moved(frame.femoral_displacement, guest.last->femoral_displacement));
    }
    guest.last = frame;
  }
  meta["packing_ms"] = milliseconds_since(packing);
  Bundle bundle(meta.dump());
  for (const auto& [key, values] : arrays) bundle.add(key, values);
  send_(guest.client, {Message::Kind::binary, std::make_shared<const std::string>(bundle.bytes())});
}

void LiveRoom::send_text(ClientId client, const Json& json) {
  send_(client, {Message::Kind::text, std::make_shared<const std::string>(json.dump())});
}

}  // namespace coxa::serve
