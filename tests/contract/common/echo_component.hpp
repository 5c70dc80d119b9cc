#pragma once

#include <chrono>
#include <string>
#include <thread>

#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/time/stamp_buffer.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/map.hpp"
#include "common/topics/services.hpp"
#include "common/topics/slam.hpp"

namespace lapis::test {

struct EchoConfig {
  int tiles = 30;
  std::string greeting = "hello";
  double answer_s = 0.0;
  int lines = 0;
};

template <class Field>
void describe(Field& field, EchoConfig& c) {
  field("tiles", c.tiles, config::in_range(0, 10000), "keyed samples published at the start");
  field("greeting", c.greeting, config::anything(), "answer of the service", config::Change::kAtRunTime);
  field("answer_s", c.answer_s, config::in_range(0.0, 10.0), "time that an answer of the service takes [s]");
  field("lines", c.lines, config::in_range(0, 1000), "lines of the log at the start");
}

/// Answers every colour image with an odometry of the same stamp; carries a topic of every kind.
class EchoComponent {
 public:
  using Config = EchoConfig;
  static constexpr const char* kName = "test_echo";
  static constexpr const char* kSummary = "Echoes images; for tests.";

  EchoComponent(const Config& config, runtime::Context& context)
      : context_(context), greeting_(config.greeting), odometry_(context.advertise(topics::kSlamOdometry)),
        path_(context.advertise(topics::kKeyframePath)), tiles_(context.advertise(topics::kVoxelTiles)) {
    context.subscribe(topics::kColor, [this](Image& m) { store(m); });
    context.serve(topics::kSaveMap, [this, config](const auto&) {
      std::this_thread::sleep_for(std::chrono::duration<double>(config.answer_s));  // work, as a save would be
      context_.status().value("answers", ++answers_);
      spdlog::debug("asked {} times", answers_);
      std_srvs::srv::Trigger_Response response;
      response.success(true);
      response.message(greeting_);
      return response;
    });
    context.on_cycle([this](const runtime::Cycle&) { work(); });
    publish_latched(config.tiles);
    for (int i = 0; i < config.lines; ++i) spdlog::debug("line {}", i);
  }

  void reconfigure(const Config& config) { greeting_ = config.greeting; }

 private:
  using Image = sensor_msgs::msg::Image;

  void store(Image& image) {
    const time::Time stamp = messages::from_message(image.header().stamp());
    const time::Push push = images_.push(stamp, std::move(image));
    if (push == time::Push::kDuplicate || push == time::Push::kLate) context_.status().count("images dropped");
  }

  void work() {
    while (!images_.empty()) {
      const auto& [stamp, image] = images_.front();
      nav_msgs::msg::Odometry message;
      message.header().stamp(messages::to_message(stamp));
      message.header().frame_id(context_.frame("map"));
      message.child_frame_id(context_.frame("base_link"));
      message.pose().pose().position().x(static_cast<double>(image.data().size()));
      message.pose().pose().orientation().w(1.0);
      odometry_.publish(message);
      context_.status().value("images", ++images_answered_);
      images_.drop_until(time::Time(stamp));
    }
  }

  void publish_latched(int tiles) {
    for (int i = 0; i < 3; ++i) {  // a late joiner gets the last one only
      nav_msgs::msg::Path path;
      path.header().frame_id(context_.frame("map"));
      path.poses().resize(static_cast<std::size_t>(i) + 1);
      path_.publish(path);
    }
    for (int i = 0; i < tiles; ++i) {
      lapis_msgs::msg::VoxelTile tile;
      tile.x(i);
      tile.version(1);
      tile.data().assign(4096, static_cast<std::uint8_t>(i));
      tiles_.publish(tile);
    }
  }

  runtime::Context& context_;
  std::string greeting_;
  dds::Publisher<nav_msgs::msg::Odometry>& odometry_;
  dds::Publisher<nav_msgs::msg::Path>& path_;
  dds::Publisher<lapis_msgs::msg::VoxelTile>& tiles_;
  time::StampBuffer<Image> images_;
  std::uint64_t images_answered_ = 0, answers_ = 0;
};

}  // namespace lapis::test
