#include "tests/benchmark/dds/lossy_link/sides.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <set>
#include <thread>
#include <vector>

#include "common/dds/executor.hpp"
#include "common/dds/publisher.hpp"
#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/map.hpp"

namespace lapis::test {
namespace {

using Clock = std::chrono::steady_clock;
using Image = sensor_msgs::msg::Image;
using Tile = lapis_msgs::msg::VoxelTile;

/// Time since the start of the machine, which both sides share.
std::int64_t now_ns() { return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count(); }

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// The smallest value that is not exceeded by this share of the values; 0 without values.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

/// The publishing side.
class Sender {
 public:
  Sender(const dds::ParticipantOptions& options, const Load& load)
      : load_(load), participant_(options), images_(participant_, topics::kColor),
        tiles_(participant_, topics::kVoxelTiles) {
    image_.data().resize(static_cast<std::size_t>(load.image_bytes), 128);
    tile_.data().resize(static_cast<std::size_t>(load.tile_bytes), 128);
    image_.encoding("rgb8");
  }

  void run() {
    executor_.every(std::chrono::milliseconds(10), [this] {
      if (!has_begun_ && images_.matched() > 0 && tiles_.matched() > 0) begin();
    });
    executor_.spin();
    const double cpu = cpu_s() - cpu_before_;
    const double seconds = 1e-9 * static_cast<double>(now_ns() - began_ns_);
    const bool is_done = wait_until_done();
    std::printf(
        "{\"images\": %d, \"tiles\": %d, \"seconds\": %.3f, \"cpu_s\": %.3f, \"failed\": %lu, "
        "\"acknowledged\": %s, \"write_p50_ms\": %.3f, \"write_p99_ms\": %.3f, \"write_max_ms\": %.3f}\n",
        load_.images, load_.tiles, seconds, cpu, images_.failed() + tiles_.failed(), is_done ? "true" : "false",
        quantile(write_ms_, 0.5), quantile(write_ms_, 0.99), quantile(write_ms_, 1.0));
  }

 private:
  void begin() {
    has_begun_ = true;
    began_ns_ = now_ns();
    cpu_before_ = cpu_s();
    next_ = Clock::now();
    send();
  }

  void send() {
    if (sent_ == load_.tiles_after) send_tiles();
    if (sent_ == load_.images) return executor_.stop();
    image_.header().stamp(messages::to_message(time::Time{now_ns()}));
    if (participant_.pace().has_room(Clock::now())) timed([this] { images_.publish(image_); });
    ++sent_;
    next_ += std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / load_.images_hz));
    executor_.at(next_, [this] { send(); });
  }

  void send_tiles() {
    tile_.epoch(now_ns());
    for (int i = 0; i < load_.tiles; ++i) {
      tile_.x(i);
      timed([this] { tiles_.publish(tile_); });
    }
  }

  template <class Write>
  void timed(const Write& write) {
    const auto begin = Clock::now();
    write();
    write_ms_.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }

  bool wait_until_done() {
    const auto deadline = Clock::now() + std::chrono::duration<double>(load_.patience_s);
    const bool is_done = tiles_.wait_until_acknowledged(load_.patience_s);
    const double left_s = std::chrono::duration<double>(deadline - Clock::now()).count();
    return images_.wait_until_acknowledged(std::max(0.001, left_s)) && is_done;
  }

  Load load_;
  dds::Participant participant_;
  dds::Publisher<Image> images_;
  dds::Publisher<Tile> tiles_;
  dds::Executor executor_;
  Image image_;
  Tile tile_;
  bool has_begun_ = false;
  int sent_ = 0;
  Clock::time_point next_;
  std::int64_t began_ns_ = 0;
  double cpu_before_ = 0.0;
  std::vector<double> write_ms_;
};

/// The subscribing side.
class Receiver {
 public:
  explicit Receiver(const dds::ParticipantOptions& options)
      : participant_(options), images_(participant_, topics::kColor, [this](const Image& image) { receive(image); }),
        tiles_(participant_, topics::kVoxelTiles, [this](const Tile& tile) { receive(tile); }) {
    executor_.add(images_);
    executor_.add(tiles_);
  }

  void run(const sigset_t& ending) {
    std::thread waiting([this, &ending] {
      int signal = 0;
      sigwait(&ending, &signal);
      executor_.stop();
    });
    executor_.spin();
    waiting.join();
    std::printf(
        "{\"images\": %zu, \"age_p50_s\": %.6f, \"age_p95_s\": %.6f, \"age_max_s\": %.6f, \"tiles\": %zu, "
        "\"tiles_s\": %.3f, \"cpu_s\": %.3f}\n",
        ages_s_.size(), quantile(ages_s_, 0.5), quantile(ages_s_, 0.95), quantile(ages_s_, 1.0), known_.size(),
        tiles_s_, cpu_s());
  }

 private:
  void receive(const Image& image) {
    const auto sent = messages::from_message(image.header().stamp());
    ages_s_.push_back(1e-9 * static_cast<double>(now_ns() - sent.nanoseconds));
  }
  void receive(const Tile& tile) {
    if (known_.insert(tile.x()).second) tiles_s_ = 1e-9 * static_cast<double>(now_ns() - tile.epoch());
  }

  dds::Participant participant_;
  std::vector<double> ages_s_;
  std::set<int> known_;   // tiles
  double tiles_s_ = 0.0;  // from the writing of the tiles to the arrival of the last new one
  dds::Subscription<Image> images_;
  dds::Subscription<Tile> tiles_;
  dds::Executor executor_;
};

}  // namespace

int publish(const dds::ParticipantOptions& options, const Load& load) {
  Sender(options, load).run();
  return 0;
}

int subscribe(const dds::ParticipantOptions& options) {
  sigset_t ending;
  sigemptyset(&ending);
  for (const int signal : {SIGTERM, SIGINT}) sigaddset(&ending, signal);
  pthread_sigmask(SIG_BLOCK, &ending, nullptr);  // before the threads of DDS, which inherit it
  Receiver(options).run(ending);
  return 0;
}

}  // namespace lapis::test
