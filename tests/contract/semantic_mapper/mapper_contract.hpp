#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "common/mapping/wire/map_mirror.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/labels.hpp"
#include "common/messages/map_description.hpp"
#include "common/messages/time.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/map.hpp"
#include "common/topics/slam.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"

namespace lapis::test {

inline constexpr const char* kMapper = "lapis_semantic_mapper";

/// A client of the map, as a planner would be one.
class MapClient {
 public:
  explicit MapClient(TopicProbe& probe) {
    probe.listen<lapis_msgs::msg::MapDescription>(topics::kMapDescription, [this](auto& m) {
      auto description = messages::from_message(m);
      if (!description) throw std::runtime_error(description.reason);
      descriptions.push_back(std::move(*description));
    });
    probe.listen<lapis_msgs::msg::VoxelTile>(topics::kVoxelTiles, [this](auto& m) {
      const auto result = mirror.apply_tile(m.epoch(), {m.x(), m.y(), m.z()}, m.version(), m.data());
      damaged += result == mapping::TileResult::kDamaged ? 1 : 0;
    });
    probe.listen<lapis_msgs::msg::MapState>(topics::kMapState, [this](auto& m) {
      states.push_back(m);
      mirror.apply_state({m.epoch(), m.version(), m.tiles(), m.checksum(), m.resolution_m()});
    });
  }
  bool has_map() const { return mirror.is_consistent() && mirror.newest_state()->tiles > 0; }

  mapping::MapMirror mirror;
  std::vector<mapping::MapDescription> descriptions;
  std::vector<lapis_msgs::msg::MapState> states;
  int damaged = 0;
};

/// The mapper with a camera and a slam that the test plays, and a client of its map. Every change is published at once.
struct MapperRun {
  /// `settings`: "key=value" each.
  explicit MapperRun(const std::vector<std::string>& settings = {}) : mapper(kMapper, arguments(settings)) {}

  bool is_ready() {
    return wait_until_ready(mapper) &&
           probe.wait_until([&] { return feed.is_matched_by_mapper() && slam.matched() > 0; }) &&
           probe.wait_until_known_by("semantic_mapper");
  }
  lapis_msgs::msg::TrackedFrame tracked(int index, std::int64_t session = 1) const {
    lapis_msgs::msg::TrackedFrame message;
    message.header().stamp(messages::to_message(CameraFeed::stamp(index)));
    message.header().frame_id(SyntheticCamera::kOpticalFrame);
    message.map_frame_id("map");
    message.session(session);
    message.state(lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING);
    message.keyframe_pose(messages::to_message(T_base_camera()));
    message.pose_in_keyframe(messages::to_message(slow_motion(index)));
    return message;
  }
  /// Sends a frame with its pose and waits until a map that contains it has arrived.
  bool map_frame(int index, std::int64_t session = 1) {
    const std::uint64_t before = client.states.empty() ? 0 : client.states.back().frames_integrated();
    send(feed.frame(index), index, session);
    return probe.wait_until([&] {
      return !client.states.empty() && client.states.back().frames_integrated() > before && client.has_map();
    });
  }
  void send(const CameraFrame& frame, int index, std::int64_t session = 1) {
    feed.send(frame);
    slam.publish(tracked(index, session));
  }
  bool wait_for_count(const std::string& text, double number) {
    return probe.wait_until([&] { return sum_of(newest_values(diagnostics, "semantic_mapper"), text) >= number; },
                            Seconds(5));
  }

  TopicProbe probe;
  CameraFeed feed{probe};
  dds::Publisher<lapis_msgs::msg::TrackedFrame>& slam = probe.advertise(topics::kTrackedFrame);
  MapClient client{probe};
  const std::vector<diagnostic_msgs::msg::DiagnosticArray>& diagnostics = probe.collect(topics::kDiagnostics);
  ChildProcess mapper;

 private:
  static std::vector<std::string> arguments(const std::vector<std::string>& settings) {
    std::vector<std::string> all{"--set", "semantic_mapper.tile_period_s=0", "--set",
                                 "semantic_mapper.view_period_s=0"};
    for (const std::string& setting : settings) all.insert(all.end(), {"--set", setting});
    return all;
  }
};

class MapperContract : public ::testing::Test, public MapperRun {
 protected:
  explicit MapperContract(const std::vector<std::string>& settings = {}) : MapperRun(settings) {}
  void SetUp() override { ASSERT_TRUE(is_ready()) << mapper.log(); }
};

}  // namespace lapis::test
