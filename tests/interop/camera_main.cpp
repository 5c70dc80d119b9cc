// Plays the synthetic camera at 10 Hz until it is stopped, so that the interop tier needs no recorded data.
#include <csignal>

#include "common/messages/time.hpp"
#include "tests/support/camera_feed.hpp"

namespace {
volatile std::sig_atomic_t stopped = 0;
}

int main() {
  std::signal(SIGTERM, [](int) { stopped = 1; });
  std::signal(SIGINT, [](int) { stopped = 1; });
  lapis::test::TopicProbe probe("camera");
  lapis::test::CameraFeed feed(probe);
  probe.participant().announce_graph();
  constexpr int kTurningPoint = 60;  // there and back again, stamps continue
  auto due = std::chrono::steady_clock::now();
  for (int index = 0; stopped == 0; ++index) {
    const int phase = index % (2 * kTurningPoint);
    auto frame = feed.frame(phase < kTurningPoint ? phase : 2 * kTurningPoint - phase);
    const auto stamp = lapis::messages::to_message(lapis::test::CameraFeed::stamp(3 * index));
    for (auto* image : {&frame.color, &frame.depth, &frame.labels}) (*image)->header().stamp(stamp);
    frame.info->header().stamp(stamp);
    feed.send(frame);
    due += std::chrono::milliseconds(100);
    probe.wait_until([&] { return stopped != 0 || std::chrono::steady_clock::now() >= due; });
  }
}
