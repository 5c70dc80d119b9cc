// How the map reaches other processes: the time from a depth image to the tiles that it changed, a reader that comes
// late to a large map, and the size of the changes beside OctoMap's full dump.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <functional>
#include <iostream>
#include <random>
#include <thread>

#include "common/mapping/wire/map_mirror.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/topics/map.hpp"
#include "common/topics/slam.hpp"
#include "semantic_mapper/conversions.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/private_domain.hpp"
#include "tests/support/synthetic_flat.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::semantic_mapper {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

double cpu_ms(const std::function<void()>& work) {
  const auto now = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
  };
  const double begin = now();
  work();
  return now() - begin;
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values.at(static_cast<std::size_t>(q * static_cast<double>(values.size() - 1)));
}

/// Mirrors the map, as a planner would.
template <class Subscribe>
void mirror_map(mapping::MapMirror& mirror, Subscribe&& subscribe) {
  subscribe(topics::kVoxelTiles, [&mirror](const lapis_msgs::msg::VoxelTile& m) {
    mirror.apply_tile(m.epoch(), {m.x(), m.y(), m.z()}, m.version(), m.data());
  });
  subscribe(topics::kMapState, [&mirror](const lapis_msgs::msg::MapState& m) {
    mirror.apply_state({m.epoch(), m.version(), m.tiles(), m.checksum(), m.resolution_m()});
  });
}

// ---- depth in -> tiles out

lapis_msgs::msg::TrackedFrame tracked(int index) {
  lapis_msgs::msg::TrackedFrame message;
  message.header().stamp(messages::to_message(test::CameraFeed::stamp(index)));
  message.header().frame_id(test::SyntheticCamera::kOpticalFrame);
  message.map_frame_id("map");
  message.session(1);
  message.state(lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING);
  message.keyframe_pose(messages::to_message(test::T_base_camera()));
  message.pose_in_keyframe(messages::to_message(test::slow_motion(index)));
  return message;
}

/// Milliseconds from before the images are sent until a mirror of the map in this process has what they changed.
std::vector<double> latencies(const std::string& resolution_m, int frames) {
  test::TopicProbe probe("camera");
  test::CameraFeed feed(probe, "", test::SyntheticCamera(640, 360));
  auto& slam = probe.advertise(topics::kTrackedFrame);
  mapping::MapMirror mirror;
  std::uint64_t integrated = 0;
  mirror_map(mirror, [&]<class Message>(const dds::Topic<Message>& topic, auto handler) {
    probe.listen<Message>(topic, [&, handler](Message& message) {
      handler(message);
      if constexpr (std::is_same_v<Message, lapis_msgs::msg::MapState>) integrated = message.frames_integrated();
    });
  });
  test::ChildProcess mapper("lapis_semantic_mapper", {"--set", "semantic_mapper.tile_period_s=0", "--set",
                                                      "semantic_mapper.resolution_m=" + resolution_m});
  const auto require = [&mapper](bool is_well) {
    if (!is_well) throw std::runtime_error("the mapper does not answer: " + mapper.log());
  };
  require(test::wait_until_ready(mapper) && probe.wait_until([&] {
    return feed.is_matched_by_mapper() && slam.matched() > 0;
  }) && probe.wait_until_known_by("semantic_mapper"));
  std::vector<double> result;
  for (int i = 0; i < frames; ++i) {
    auto frame = feed.frame(i);
    frame.color.reset();
    const auto begin = Clock::now();
    feed.send(frame);
    slam.publish(tracked(i));
    require(
        probe.wait_until([&] { return integrated == static_cast<std::uint64_t>(i) + 1 && mirror.is_consistent(); }));
    if (i > 0) result.push_back(ms_since(begin));  // the first one may wait for labels
  }
  return result;
}

void measure_latency(int frames) {
  std::printf(
      "| voxel [m] | frames | depth in -> tiles mirrored p50 [ms] | p95 [ms] | longest [ms] |\n"
      "| --- | --- | --- | --- | --- |\n");
  for (const char* resolution : {"0.25", "0.1", "0.05"}) {
    const auto ms = latencies(resolution, frames);
    std::printf("| %s | %zu | %.1f | %.1f | %.1f |\n", resolution, ms.size(), quantile(ms, 0.5), quantile(ms, 0.95),
                quantile(ms, 1.0));
    std::fflush(stdout);
  }
}

// ---- a late joiner

/// Says how long it took to have the whole map.
struct ReaderConfig {};

template <class Field>
void describe(Field& /*field*/, ReaderConfig& /*c*/) {}

class ReaderComponent {
 public:
  using Config = ReaderConfig;
  static constexpr const char* kName = "map_reader";
  static constexpr const char* kSummary = "Mirrors the map, for lapis_semantic_mapper_delivery_benchmark.";

  ReaderComponent(const Config& /*config*/, runtime::Context& context) {
    mirror_map(mirror_, [&]<class Message>(const dds::Topic<Message>& topic, auto handler) {
      context.subscribe(topic, [this, handler](const Message& message) {
        if (is_complete_) return;
        work_ms_ += cpu_ms([&] { handler(message); });
        is_complete_ = mirror_.is_consistent();
        if (is_complete_) spdlog::info("complete after {} ms, of work: {} ms", ms_since(begin_), work_ms_);
      });
    });
  }

 private:
  Clock::time_point begin_ = Clock::now();
  mapping::MapMirror mirror_;
  double work_ms_ = 0.0;  ///< of the mirror
  bool is_complete_ = false;
};

/// Publishes as SemanticMapperComponent does; knows how long each write() took.
class MapPublisher {
 public:
  explicit MapPublisher(runtime::Context& context)
      : tiles_(context.advertise(topics::kVoxelTiles)), state_(context.advertise(topics::kMapState)) {}

  void publish(SemanticMapper& mapper) {
    for (const TileUpdate& tile : mapper.take_changed_tiles()) {
      bytes += tile.bytes.size();
      ++tiles;
      const auto message = to_message(tile, 1);
      write([&] { tiles_.publish(message); });
    }
    const mapping::MapState state = mapper.state();
    lapis_msgs::msg::MapState message;
    message.epoch(1);
    message.version(state.version);
    message.resolution_m(state.resolution_m);
    message.tiles(state.tiles);
    message.checksum(state.checksum);
    write([&] { state_.publish(message); });
  }

  double longest_write_ms() const { return write_ms.empty() ? 0.0 : quantile(write_ms, 1.0); }

  std::vector<double> write_ms;
  std::size_t bytes = 0, tiles = 0;

 private:
  void write(const std::function<void()>& work) {
    const auto begin = Clock::now();
    work();
    write_ms.push_back(ms_since(begin));
  }

  dds::Publisher<lapis_msgs::msg::VoxelTile>& tiles_;
  dds::Publisher<lapis_msgs::msg::MapState>& state_;
};

constexpr double kLargeMapResolution_m = 0.05;

/// Space of 4 m in height whose voxels were all seen, half of them as a surface: some 1.5 kB a block.
mapping::VoxelMap large_map(std::size_t blocks) {
  std::mt19937 random(1);
  std::vector<mapping::VoxelBlock> patterns(64);
  for (mapping::VoxelBlock& block : patterns) {
    for (int offset = 0; offset < mapping::kBlockVoxels; ++offset) {
      block.add_miss(offset, mapping::kOneVote * (1 + static_cast<std::uint32_t>(random() % 40)));
      if (random() % 2 == 0)
        block.add_hit(offset, static_cast<std::uint16_t>(1 + random() % 40),
                      mapping::kOneVote * (1 + static_cast<std::uint32_t>(random() % 40)));
    }
  }
  mapping::VoxelMap map(kLargeMapResolution_m);
  constexpr std::int32_t kHeight = 12, kWidth = 64;
  for (std::size_t i = 0; i < blocks; ++i) {
    const auto n = static_cast<std::int32_t>(i);
    map.set_block({n / (kHeight * kWidth) + 100, n / kHeight % kWidth, n % kHeight},
                  patterns[random() % patterns.size()]);
  }
  return map;
}

AnchoredFrame room_frame(int index, const geometry::PinholeCamera& camera) {
  const geometry::Pose T = test::look({0.0, 0.0, 1.0}, 0.1 * index, 0.1);
  const auto image = test::render(test::furnished_room(), camera, T);
  std::string error;
  return {time::Time::from_seconds(index / 2.0),
          0,
          geometry::Pose::Identity(),
          T,
          1,
          mapping::CompactFrame::make(camera, image.depth, &image.labels, {}, error).value()};
}

/// A reader comes to a map that keeps growing at 2 Hz.
void join(double tile_edge_m, std::size_t blocks, int socket_buffer_bytes) {
  MapperConfig config;
  config.resolution_m = kLargeMapResolution_m;
  config.tile_edge_m = tile_edge_m;
  SemanticMapper mapper(config, large_map(blocks));
  runtime::ContextOptions options{"mapper", test::participant_options("mapper")};
  options.participant.socket_buffer_bytes = socket_buffer_bytes;
  runtime::Context context(options);
  MapPublisher publisher(context);
  publisher.publish(mapper);
  const double mb = 1e-6 * static_cast<double>(publisher.bytes);
  const std::size_t tiles = publisher.tiles;
  publisher.write_ms.clear();
  test::ChildProcess reader("/proc/self/exe",
                            {"--reader", "--set", "dds.socket_buffer_bytes=" + std::to_string(socket_buffer_bytes)});
  const geometry::PinholeCamera camera{160, 90, 80, 80, 79.5, 44.5};
  int index = 0;
  while (!reader.wait_for_line("complete after", test::Seconds(0.5))) {
    if (++index > 60) throw std::runtime_error("the reader is not complete after 30 s: " + reader.log());
    mapper.integrate(room_frame(index, camera));
    publisher.publish(mapper);
  }
  const std::string log = reader.log();
  const auto number_after = [&log](const std::string& words) {
    return std::stod(log.substr(log.find(words) + words.size()));
  };
  std::printf("| %d | %.1f | %zu | %.1f | %.0f | %.0f | %.1f |\n", socket_buffer_bytes, tile_edge_m, tiles, mb,
              number_after("complete after "), number_after("of work: "), publisher.longest_write_ms());
  std::fflush(stdout);
}

void measure_join(std::size_t blocks) {
  std::printf(
      "| socket buffers [B] | tile edge [m] | tiles | map [MB] | late joiner complete [ms] | CPU of its mirror [ms] | "
      "longest write() [ms] |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const int socket_buffer_bytes : {4 << 20, 212992})
    for (const double tile_edge_m : {0.8, 1.6}) join(tile_edge_m, blocks, socket_buffer_bytes);
}

// ---- a reader that hangs

/// Publishes a map that changes at 15 Hz for so long: the clock stands for the camera, there is no event to wait for.
void publish_for(double seconds, MapPublisher& publisher, SemanticMapper& mapper, int& index) {
  const geometry::PinholeCamera camera{160, 90, 80, 80, 79.5, 44.5};
  publisher.write_ms.clear();
  const auto begin = Clock::now();
  for (int i = 0; i < 15.0 * seconds; ++i) {
    std::this_thread::sleep_until(begin + i * std::chrono::milliseconds(1000) / 15);
    mapper.integrate(room_frame(++index, camera));
    publisher.publish(mapper);
  }
}

/// Longer than the lease of 3 s, after which the writer forgets the reader.
void measure_stuck_reader(double seconds) {
  MapperConfig config;
  config.resolution_m = 0.1;
  SemanticMapper mapper(config);
  runtime::Context context({"mapper", test::participant_options("mapper")});
  MapPublisher publisher(context);
  test::ChildProcess reader("/proc/self/exe", {"--reader"});
  int index = 0;
  while (!reader.wait_for_line("complete after", test::Seconds(0.1))) {
    if (index > 600) throw std::runtime_error("the reader is not complete after 40 s: " + reader.log());
    publish_for(1.0, publisher, mapper, index);
  }
  std::printf("\n| reader | write() of %.0f s at 15 Hz | p50 [ms] | p99 [ms] | longest [ms] |\n", seconds);
  std::printf("| --- | --- | --- | --- | --- |\n");
  for (const char* state : {"well", "stopped"}) {
    if (state == std::string("stopped")) reader.signal(SIGSTOP);
    publish_for(seconds, publisher, mapper, index);
    const auto& ms = publisher.write_ms;
    std::printf("| %s | %zu | %.2f | %.2f | %.1f |\n", state, ms.size(), quantile(ms, 0.5), quantile(ms, 0.99),
                quantile(ms, 1.0));
  }
  std::fflush(stdout);
}

// ---- changes beside a full dump

void measure_dump(int per_room) {
  constexpr int kFramesPerVersion = 8;  // 2 Hz at 15 Hz
  MapperConfig config;
  config.resolution_m = 0.1;
  SemanticMapper mapper(config);
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  const auto flat = test::furnished_flat();
  const auto poses = test::walk_through_flat(per_room);
  const geometry::PinholeCamera camera{640, 360, 320, 320, 319.5, 179.5};
  double delta_ms = 0.0, dump_ms = 0.0, delta_bytes = 0.0, dump_bytes = 0.0, tiles = 0.0;
  int versions = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto image = test::render(flat, camera, poses[i]);
    std::string error;
    mapper.integrate({time::Time::from_seconds(static_cast<double>(i) / 15.0), 0, geometry::Pose::Identity(), poses[i],
                      1, mapping::CompactFrame::make(camera, image.depth, &image.labels, {}, error).value()});
    if (i % kFramesPerVersion != 0) continue;
    const bool is_steady = 3 * i > 2 * poses.size();  // the last third of the walk
    const double ms = cpu_ms([&] {
      for (const TileUpdate& tile : mapper.take_changed_tiles()) {
        const auto message = to_message(tile, 1);
        if (!is_steady) continue;
        delta_bytes += static_cast<double>(message.data().size()) + 40.0;  // key, epoch, version, RTPS header
        ++tiles;
      }
    });
    if (!is_steady) continue;
    ++versions;
    delta_ms += ms;
    dump_ms += cpu_ms([&] {
      const auto message = to_message(encode_octree(mapper.map(), reader, {}), config.resolution_m, {});
      dump_bytes += static_cast<double>(message.data().size());
    });
  }
  std::printf("| %d | %.0f | %.1f | %.1f | 1/%.1f | %.2f | %.1f | 1/%.0f |\n", versions, tiles / versions,
              1e-3 * delta_bytes / versions, 1e-3 * dump_bytes / versions, dump_bytes / delta_bytes,
              delta_ms / versions, dump_ms / versions, dump_ms / delta_ms);
}

int benchmark(int argc, char** argv) {
  CLI::App app("How the map reaches other processes: latency, late joiners, a reader that hangs, size of the changes",
               "lapis_semantic_mapper_delivery_benchmark");
  int frames = 300, per_room = 60;
  std::size_t blocks = 65000;
  double stuck_s = 8.0;
  app.add_option("--frames", frames, "of which the latency is measured")->check(CLI::Range(2, 100000));
  app.add_option("--blocks", blocks, "of the large map; 65,000 are 100 MB")->check(CLI::Range(1, 1000000));
  app.add_option("--per-room", per_room, "frames in each of the flat's six rooms")->check(CLI::Range(10, 1000));
  app.add_option("--stuck", stuck_s, "time for which a reader hangs [s]")->check(CLI::Range(1.0, 600.0));
  CLI11_PARSE(app, argc, argv);
  spdlog::set_level(spdlog::level::warn);
  test::enter_private_domain();
  measure_latency(frames);
  std::printf("\n");
  measure_join(blocks);
  measure_stuck_reader(stuck_s);
  std::printf(
      "\nChanges of 0.5 s at 0.1 m, last third of a walk through a flat of 24 m x 12.8 m, beside the whole map:\n"
      "| versions | tiles | tiles [kB] | octomap [kB] | ratio | tiles CPU [ms] | octomap CPU [ms] | ratio |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  measure_dump(per_room);
  return 0;
}

}  // namespace
}  // namespace lapis::semantic_mapper

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--reader") {
    argv[1] = argv[0];
    return lapis::runtime::run_component<lapis::semantic_mapper::ReaderComponent>(argc - 1, argv + 1);
  }
  try {
    return lapis::semantic_mapper::benchmark(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "lapis_semantic_mapper_delivery_benchmark: " << error.what() << '\n';
    return 1;
  }
}
