#include "live_room.h"

#include "live_answer.h"

#include <coxa/core/error.h>

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

}  // namespace

/// One connection's hip. `hip` and what belongs to it are touched by the solver's thread alone; the
/// rest is guarded by the room's mutex.
struct LiveRoom::Guest {
  ClientId client = 0;
  std::optional<Question> waiting;
  bool working = false;
  std::atomic<bool> interrupt{false};  ///< ends a settling that is no longer wanted

  CaseFolder::Hip source;
  LiveSurfaces surfaces;
  std::unique_ptr<joint::LiveHip> hip;
  std::optional<joint::FrameResult> last;  ///< the last step, to compare the exact state with

  void seat(const CaseFolder& folder);
  joint::LiveHip::Step solve(const Question& question);
  /// The state reached, as the browser gets it.
  std::string packed(const Question& question, const joint::LiveHip::Step& step, double solver_ms);
};

void LiveRoom::Guest::seat(const CaseFolder& folder) {
  source = folder.read_hip();
  surfaces = {body_surface(source.model.acetabular_cartilage),
              body_surface(source.model.femoral_cartilage)};
  hip = std::make_unique<joint::LiveHip>(source.model, source.load);
}

joint::LiveHip::Step LiveRoom::Guest::solve(const Question& question) {
  Monitor monitor;
  if (!question.exact) return hip->step_towards(question.target, monitor);
  monitor.cancel_flag = &interrupt;
  return hip->settle(monitor);
}

std::string LiveRoom::Guest::packed(const Question& question, const joint::LiveHip::Step& step,
                                    double solver_ms) {
  const auto start = Clock::now();
  const joint::FrameResult& frame = step.frame;
  Json meta = live_meta(step, hip->angles());
  meta["type"] = question.exact ? "settled" : "step";
  meta["number"] = question.number;
  meta["arrived"] = step.arrived;
  meta["solver_ms"] = solver_ms;
  Bundle bundle;
  if (frame.status == joint::FrameStatus::converged) {
    const joint::JointModel& model = source.model;
    add_live_state(bundle, model, surfaces, frame, question.field);
    meta["tets"] = model.acetabular_cartilage.n_tets() + model.femoral_cartilage.n_tets();
    if (question.exact && last) meta.update(live_error(frame, *last));
    last = frame;
  }
  meta["packing_ms"] = milliseconds_since(start);
  bundle.set_meta(meta.dump());
  return bundle.bytes();
}

LiveRoom::~LiveRoom() {
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [client, guest] : guests_) guest->waiting.reset(), guest->interrupt = true;
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
  it->second->waiting.reset();
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
  guest->waiting = question;
  guest->interrupt = true;
  if (guest->working) return;
  guest->working = true;
  boost::asio::post(thread_, [this, guest] { work(guest); });
}

void LiveRoom::work(const std::shared_ptr<Guest>& guest) {
  Question question;
  {
    const std::lock_guard lock(mutex_);
    if (!guest->waiting) {
      guest->working = false;
      return;
    }
    question = *guest->waiting;
    guest->waiting.reset();
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
  if (!guest.hip) guest.seat(folder_);
  const auto start = Clock::now();
  const joint::LiveHip::Step step = guest.solve(question);
  const double solver_ms = milliseconds_since(start);
  send_(guest.client, {Message::Kind::binary, std::make_shared<const std::string>(
                                                  guest.packed(question, step, solver_ms))});
}

void LiveRoom::send_text(ClientId client, const Json& json) {
  send_(client, {Message::Kind::text, std::make_shared<const std::string>(json.dump())});
}

}  // namespace coxa::serve
