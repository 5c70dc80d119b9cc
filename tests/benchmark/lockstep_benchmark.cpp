// What a tick of lock-step costs when the participants do no work: 1.84 MB of images from one process to three, which
// answer one after the other. The processes are this executable, started again with --participant.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <iostream>

#include "common/messages/time.hpp"
#include "common/runtime/lockstep_driver.hpp"
#include "common/runtime/run_component.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/slam.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/private_domain.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using runtime::LockstepDriver;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kColorBytes = 691'200;  // 640 x 360 rgb8
constexpr std::size_t kDepthBytes = 921'600;  // 640 x 360 32FC1
constexpr std::size_t kLabelBytes = 230'400;  // 640 x 360 mono8

struct NoConfig {};

template <class Field>
void describe(Field& /*field*/, NoConfig& /*c*/) {}

/// Takes part in every tick and does nothing: the first stage publishes an odometry for which the others wait.
template <int kStage>
class IdleComponent {
 public:
  using Config = NoConfig;
  static constexpr const char* kName = kStage == 0 ? "idle_0" : kStage == 1 ? "idle_1" : "idle_2";
  static constexpr const char* kSummary = "Does nothing, for lapis_lockstep_benchmark.";

  IdleComponent(const Config& /*config*/, runtime::Context& context) {
    context.subscribe(topics::kColor, [](const auto&) {});
    context.subscribe(topics::kDepth, [](const auto&) {});
    context.subscribe(topics::kLabels, [](const auto&) {});
    if constexpr (kStage == 0) {
      auto& odometry = context.advertise(topics::kSlamOdometry);
      context.on_cycle([&odometry](const runtime::Cycle& cycle) {
        if (cycle.inputs_complete) odometry.publish({});
      });
    } else {
      context.subscribe(topics::kSlamOdometry, [](const auto&) {});
    }
  }
};

int run_participant(int argc, char** argv) {
  const std::string stage = argv[2];
  argv[2] = argv[0];
  if (stage == "0") return runtime::run_component<IdleComponent<0>>(argc - 2, argv + 2);
  if (stage == "1") return runtime::run_component<IdleComponent<1>>(argc - 2, argv + 2);
  return runtime::run_component<IdleComponent<2>>(argc - 2, argv + 2);
}

double cpu_s(pid_t process) {
  clockid_t clock{};
  timespec t{};
  if (process == 0) {
    clock = CLOCK_PROCESS_CPUTIME_ID;
  } else if (clock_getcpuclockid(process, &clock) != 0) {
    return 0.0;
  }
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

sensor_msgs::msg::Image image(std::size_t bytes) {
  sensor_msgs::msg::Image message;
  message.data().resize(bytes, 128);
  return message;
}

/// The clock's side: publishes three images per tick.
class Sensor {
 public:
  explicit Sensor(int socket_buffer_bytes)
      : context_(options(socket_buffer_bytes)), color_(context_.advertise(topics::kColor)),
        depth_(context_.advertise(topics::kDepth)), labels_(context_.advertise(topics::kLabels)),
        color_image_(image(kColorBytes)), depth_image_(image(kDepthBytes)), label_image_(image(kLabelBytes)),
        driver_(context_, {{"idle_0", "idle_1", "idle_2"}, 5.0, 30.0, "abort"}, [this] { publish(); }) {}

  /// Waits until the last tick has been answered; throws when a participant is missing.
  void wait_until_idle() {
    while (driver_.state() != LockstepDriver::State::kIdle) {
      if (driver_.state() == LockstepDriver::State::kFailed) throw std::runtime_error(driver_.failure());
      context_.executor().spin_once(std::chrono::milliseconds(100));
    }
  }
  void tick() {
    stamp_ = stamp_ + time::Duration{33'333'333};
    publish();
    driver_.begin(stamp_, false);
    wait_until_idle();
  }

 private:
  static runtime::ContextOptions options(int socket_buffer_bytes) {
    runtime::ContextOptions result{"sensor", participant_options("sensor")};
    result.participant.socket_buffer_bytes = socket_buffer_bytes;
    return result;
  }
  void publish() {
    for (auto* message : {&color_image_, &depth_image_, &label_image_}) {
      message->header().stamp(messages::to_message(stamp_));
    }
    color_.publish(color_image_);
    depth_.publish(depth_image_);
    labels_.publish(label_image_);
  }

  runtime::Context context_;
  dds::Publisher<sensor_msgs::msg::Image>& color_;
  dds::Publisher<sensor_msgs::msg::Image>& depth_;
  dds::Publisher<sensor_msgs::msg::Image>& labels_;
  sensor_msgs::msg::Image color_image_;
  sensor_msgs::msg::Image depth_image_;
  sensor_msgs::msg::Image label_image_;
  time::Time stamp_;
  LockstepDriver driver_;
};

struct Measured {
  std::vector<double> wall_ms;  // per tick
  std::vector<double> cpu_ms;   // per process and tick: sensor, idle_0, idle_1, idle_2
};

Measured measure(int ticks, int socket_buffer_bytes) {
  const std::string buffers = "dds.socket_buffer_bytes=" + std::to_string(socket_buffer_bytes);
  std::vector<std::unique_ptr<ChildProcess>> participants;
  for (const char* stage : {"0", "1", "2"}) {
    participants.push_back(std::make_unique<ChildProcess>(
        "/proc/self/exe", std::vector<std::string>{"--participant", stage, "--set", buffers}));
  }
  Sensor sensor(socket_buffer_bytes);
  sensor.wait_until_idle();
  constexpr int kWarmUp = 50;
  for (int i = 0; i < kWarmUp; ++i) sensor.tick();
  std::vector<pid_t> processes = {0};
  for (const auto& participant : participants) processes.push_back(participant->pid());
  Measured measured;
  for (const pid_t process : processes) measured.cpu_ms.push_back(-1e3 * cpu_s(process));
  for (int i = 0; i < ticks; ++i) {
    const auto begin = Clock::now();
    sensor.tick();
    measured.wall_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }
  for (std::size_t i = 0; i < processes.size(); ++i) {
    measured.cpu_ms[i] = (measured.cpu_ms[i] + 1e3 * cpu_s(processes[i])) / ticks;
  }
  return measured;
}

void print(Measured measured, int socket_buffer_bytes) {
  auto& wall = measured.wall_ms;
  double total_ms = 0.0;
  for (const double ms : wall) total_ms += ms;
  std::sort(wall.begin(), wall.end());
  const auto at = [&](double share) {
    return wall[static_cast<std::size_t>(share * static_cast<double>(wall.size() - 1))];
  };
  std::printf("lock-step, 1,843,200 B per tick to 3 participants that do no work, socket buffers %d B\n\n",
              socket_buffer_bytes);
  std::printf("| ticks/s | wall per tick p50 | p99 | max [ms] |\n| --- | --- | --- | --- |\n");
  std::printf("| %.0f | %.2f | %.2f | %.2f |\n\n", 1e3 * static_cast<double>(wall.size()) / total_ms, at(0.5), at(0.99),
              wall.back());
  std::printf("| process | CPU per tick [ms] |\n| --- | --- |\n");
  double sum = 0.0;
  for (std::size_t i = 0; i < measured.cpu_ms.size(); ++i) {
    const std::string name = i == 0 ? "sensor" : "idle_" + std::to_string(i - 1);
    std::printf("| %s | %.2f |\n", name.c_str(), measured.cpu_ms[i]);
    sum += measured.cpu_ms[i];
  }
  std::printf("| all | %.2f |\n", sum);
}

int benchmark(int argc, char** argv) {
  CLI::App app("CPU and wall time of a lock-step tick whose participants do no work", "lapis_lockstep_benchmark");
  int ticks = 1000;
  int socket_buffer_bytes = 4 << 20;
  app.add_option("--ticks", ticks, "ticks to measure, after 50 to warm up")->check(CLI::Range(1, 1'000'000));
  app.add_option("--socket-buffer", socket_buffer_bytes, "size of the UDP socket buffers [B]");
  CLI11_PARSE(app, argc, argv);
  spdlog::set_level(spdlog::level::warn);
  enter_private_domain();
  print(measure(ticks, socket_buffer_bytes), socket_buffer_bytes);
  return 0;
}

}  // namespace
}  // namespace lapis::test

int main(int argc, char** argv) {
  if (argc > 2 && std::string(argv[1]) == "--participant") return lapis::test::run_participant(argc, argv);
  try {
    return lapis::test::benchmark(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "lapis_lockstep_benchmark: " << error.what() << '\n';
    return 1;
  }
}
