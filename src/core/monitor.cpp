#include <coxa/core/monitor.h>

#include <coxa/core/error.h>

#include <utility>

namespace coxa {

void Monitor::progress(std::string_view stage, double share) const {
  if (on_progress) on_progress(stage, share);
}

void Monitor::warn(const std::string& text) const {
  if (on_warning) on_warning(text);
}

void Monitor::check_cancelled() const {
  if (cancelled()) fail(ErrorCode::cancelled, "interrupted; finished stages are kept");
}

Monitor part_of(const Monitor& parent, std::string stage, double from, double to) {
  Monitor part = parent;
  if (parent.on_progress) {
    part.on_progress = [report = parent.on_progress, stage = std::move(stage), from, to](
                           std::string_view, double share) {
      report(stage, from + (to - from) * share);
    };
  }
  return part;
}

}  // namespace coxa
