#include <coxa/core/monitor.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

namespace coxa {

TEST(Monitor, IgnoresEverythingByDefault) {
  const Monitor silent;
  silent.progress("mesh", 0.5);
  silent.warn("thin");
  EXPECT_NO_THROW(silent.check_cancelled());
}
TEST(Monitor, ThrowsCancelledOnceTheFlagIsUp) {
  std::atomic<bool> flag{false};
  Monitor monitor;
  monitor.cancel_flag = &flag;
  monitor.check_cancelled();
  flag = true;
  try {
    monitor.check_cancelled();
    FAIL() << "not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}
TEST(PartOf, MapsItsSharesIntoTheParentsRange) {
  std::string stage;
  double share = -1.0;
  Monitor parent;
  parent.on_progress = [&](std::string_view s, double value) { stage = s, share = value; };
  part_of(parent, "segment", 0.2, 0.6).progress("inner", 0.5);
  EXPECT_EQ(stage, "segment");
  EXPECT_DOUBLE_EQ(share, 0.4);
}

}  // namespace coxa
