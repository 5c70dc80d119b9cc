// Prints a line per sample of the chain's topics, so that a test written in a script can see what is published:
//   TOPIC stamp_s DETAIL
// with the number of the session (/slam/frame), the id of a new key-frame (keyframe), the number of the integrated
// frames (map_state), the process, its number of frames and its name with the namespace (/diagnostics), or x and y
// (truth: /ground_truth/odom) [m]; and with the time of its arrival [s, steady clock] in the stamp's place
//   arrived arrival_s pose|map|path|command [FORWARD TURN]
// for what the robot must not move without, and for /cmd_vel [m/s, rad/s]. It saves the map when SIGUSR1 comes and
// prints the answer. It ends on SIGTERM.

#include <chrono>
#include <csignal>
#include <iostream>
#include <optional>
#include <string>

#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/controller.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/ground_truth.hpp"
#include "common/topics/map.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/services.hpp"
#include "common/topics/slam.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

volatile std::sig_atomic_t is_asked_to_stop = 0;
volatile std::sig_atomic_t is_asked_to_save = 0;

template <class Stamp>
void print(const char* topic, const Stamp& stamp, const std::string& detail) {
  std::cout << topic << ' ' << time::to_string(messages::from_message(stamp)) << ' ' << detail << std::endl;
}

void print_diagnostics(const diagnostic_msgs::msg::DiagnosticArray& message) {
  for (const auto& status : message.status()) {
    std::string frames = "0";
    for (const auto& pair : status.values()) {
      if (pair.key() == "frames") frames = pair.value();
    }
    print("diagnostics", message.header().stamp(), status.hardware_id() + " " + frames + " " + status.name());
  }
}

void print_arrival(const std::string& what) {
  const std::chrono::duration<double> now = std::chrono::steady_clock::now().time_since_epoch();
  std::cout << "arrived " << std::fixed << now.count() << ' ' << what << std::endl;
}

void listen_to_arrivals(TopicProbe& probe) {
  probe.listen<nav_msgs::msg::Odometry>(topics::kSlamOdometry, [](auto&) { print_arrival("pose"); });
  probe.listen<nav_msgs::msg::OccupancyGrid>(topics::kObstacles, [](auto&) { print_arrival("map"); });
  probe.listen<nav_msgs::msg::Path>(topics::kPlannerPath, [](auto&) { print_arrival("path"); });
  probe.listen<lapis_msgs::msg::PlannerStatus>(topics::kPlannerStatus, [](auto&) { print_arrival("path"); });
  probe.listen<geometry_msgs::msg::Twist>(topics::kCommand, [](auto& m) {
    print_arrival("command " + std::to_string(m.linear().x()) + ' ' + std::to_string(m.angular().z()));
  });
}

void listen(TopicProbe& probe) {
  probe.listen<sensor_msgs::msg::CameraInfo>(topics::kColorInfo,
                                             [](auto& m) { print("camera", m.header().stamp(), ""); });
  probe.listen<lapis_msgs::msg::TrackedFrame>(topics::kTrackedFrame, [](auto& m) {
    print("slam", m.header().stamp(), std::to_string(m.session()));
    if (m.is_keyframe()) print("keyframe", m.header().stamp(), std::to_string(m.keyframe_id()));
  });
  probe.listen<lapis_msgs::msg::MapState>(topics::kMapState, [](auto& m) {
    print("semantic_mapper", m.header().stamp(), std::to_string(m.frames_integrated()));
  });
  probe.listen<nav_msgs::msg::Odometry>(topics::kGroundTruth, [](auto& m) {
    const auto& position = m.pose().pose().position();
    print("truth", m.header().stamp(), std::to_string(position.x()) + ' ' + std::to_string(position.y()));
  });
  probe.listen<diagnostic_msgs::msg::DiagnosticArray>(topics::kDiagnostics, [](auto& m) { print_diagnostics(m); });
}

void save(TopicProbe& probe, dds::ServiceClient<std_srvs::srv::Trigger>& client) {
  const auto number = client.call({});
  std::optional<std_srvs::srv::Trigger_Response> answer;
  if (number) probe.wait_until([&] { return (answer = client.take_reply(*number)).has_value(); }, Seconds(20));
  if (!answer) {
    std::cout << "save unanswered" << std::endl;
  } else {
    std::cout << "save " << (answer->success() ? "done: " : "refused: ") << answer->message() << std::endl;
  }
}

}  // namespace
}  // namespace lapis::test

int main() {
  using namespace lapis::test;
  std::signal(SIGTERM, [](int) { is_asked_to_stop = 1; });
  std::signal(SIGUSR1, [](int) { is_asked_to_save = 1; });
  TopicProbe probe("stamp_probe");
  listen(probe);
  listen_to_arrivals(probe);
  auto& client = probe.client(lapis::topics::kSaveMap);
  std::cout << "stamp_probe: ready" << std::endl;
  while (is_asked_to_stop == 0) {
    probe.wait_until([] { return is_asked_to_stop != 0 || is_asked_to_save != 0; }, Seconds(1));
    if (is_asked_to_save == 0) continue;
    is_asked_to_save = 0;  // before the answer is printed, which may bring the next request
    save(probe, client);
  }
  return 0;
}
