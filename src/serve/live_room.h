#pragma once

#include <coxa/joint/live.h>
#include <coxa/serve/server.h>

#include <atomic>
#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <map>
#include <mutex>

#include "case_folder.h"

namespace coxa::serve {

/// The live examinations: one hip per connection, all solved on one thread, in turn.
///
/// A pose asked for while the last one is being solved replaces it; so does a pose while a state is
/// settled exactly, which is then broken off. Every answer carries the number of its question.
class LiveRoom {
 public:
  using Send = std::function<void(ClientId, Message)>;
  LiveRoom(const CaseFolder& folder, Send send) : folder_(folder), send_(std::move(send)) {}
  ~LiveRoom();

  /// A step towards a pose; the first one reads the hip and seats it. The answer carries the values
  /// of `field` alone; computing all would take a fifth of the solver's time.
  void pose(ClientId client, std::int64_t number, const motion::HipAngles& target,
            const std::string& field);
  /// The exact equilibrium at the present pose, with all fields.
  void settle(ClientId client, std::int64_t number);
  void leave(ClientId client);

 private:
  struct Guest;
  struct Question {
    std::int64_t number = 0;
    bool exact = false;
    motion::HipAngles target;
    std::string field;
  };
  void ask(ClientId client, const Question& question);
  void work(const std::shared_ptr<Guest>& guest);
  void answer(Guest& guest, const Question& question);
  void send_text(ClientId client, const nlohmann::json& json);

  const CaseFolder& folder_;
  Send send_;
  std::mutex mutex_;
  std::map<ClientId, std::shared_ptr<Guest>> guests_;
  boost::asio::thread_pool thread_{1};
};

}  // namespace coxa::serve
