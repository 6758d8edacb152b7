#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <string_view>

namespace coxa {

/// Where long work reports to and learns of Ctrl-C. A default-constructed Monitor ignores
/// everything.
///
/// @note passed by const&; refers to the cancel flag, which must outlive it.
struct Monitor {
  std::function<void(std::string_view stage, double share)> on_progress;  ///< share in [0, 1]
  std::function<void(std::string_view text)> on_warning;
  const std::atomic<bool>* cancel_flag = nullptr;

  void progress(std::string_view stage, double share) const;
  void warn(const std::string& text) const;
  bool cancelled() const { return cancel_flag != nullptr && cancel_flag->load(); }
  /// @throws Error cancelled, when the user has asked to stop.
  void check_cancelled() const;
};

/// A monitor whose shares [0, 1] fill [from, to] of `parent`; the stage name is the parent's choice
/// `stage`.
Monitor part_of(const Monitor& parent, std::string stage, double from, double to);

}  // namespace coxa
