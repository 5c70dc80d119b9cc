// The other side of the echo component, for a test that is written in a script: publishes images, calls the service and
// listens to all topics of the echo. Prints a line per answer. It ends on SIGTERM.
//   lapis_test_packet_partner IMAGE_BYTES PERIOD_S

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/map.hpp"
#include "common/topics/services.hpp"
#include "common/topics/slam.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

volatile std::sig_atomic_t is_asked_to_stop = 0;

time::Time now() {
  return time::Time{std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count()};
}

void run(std::size_t image_bytes, Seconds period) {
  TopicProbe probe("packet_partner");
  auto& images = probe.advertise(topics::kColor);
  auto& save = probe.client(topics::kSaveMap);
  std::int64_t answers = 0;
  probe.listen<nav_msgs::msg::Odometry>(topics::kSlamOdometry,
                                        [&](auto&) { std::cout << "answer " << ++answers << std::endl; });
  probe.listen<nav_msgs::msg::Path>(topics::kKeyframePath, [](auto&) {});
  probe.listen<lapis_msgs::msg::VoxelTile>(topics::kVoxelTiles, [](auto&) {});
  probe.listen<diagnostic_msgs::msg::DiagnosticArray>(topics::kDiagnostics, [](auto&) {});
  sensor_msgs::msg::Image image;
  image.data().resize(image_bytes);
  for (std::int64_t number = 1; is_asked_to_stop == 0; ++number) {
    image.header().stamp(messages::to_message(now()));
    images.publish(image);
    if (number % 10 == 0) save.call({});
    probe.wait_until([] { return is_asked_to_stop != 0; }, period);
  }
}

}  // namespace
}  // namespace lapis::test

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "use: lapis_test_packet_partner IMAGE_BYTES PERIOD_S\n";
    return 2;
  }
  std::signal(SIGTERM, [](int) { lapis::test::is_asked_to_stop = 1; });
  lapis::test::run(std::strtoul(argv[1], nullptr, 10), lapis::test::Seconds(std::strtod(argv[2], nullptr)));
}
