#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>
#include <memory>

#include "command_line/commands.hpp"
#include "command_line/core/rate_meter.hpp"
#include "command_line/topic_reader.hpp"
#include "common/cdr/text.hpp"

namespace lapis::command_line {
namespace {

constexpr Seconds kReportPeriod{1.0};

struct RateOptions {
  std::string topic;
  std::size_t window = 1000;
  double seconds = 0.0;  ///< 0: no end
};

/// Prints what has been measured.
using Report = void (*)(const std::string& topic, const RateMeter::Rate& rate, std::uint64_t lost, bool is_json);

void report_rate(const std::string& topic, const RateMeter::Rate& rate, std::uint64_t lost, bool is_json) {
  if (is_json) {
    std::cout << cdr::to_json({{"topic", topic},
                               {"rate_hz", rate.rate_hz},
                               {"shortest_gap_s", rate.shortest_gap_s},
                               {"longest_gap_s", rate.longest_gap_s},
                               {"deviation_s", rate.deviation_s},
                               {"window", rate.in_window},
                               {"messages", rate.messages},
                               {"lost", lost}})
              << '\n';
    return;
  }
  std::printf("%.3f Hz, gaps %.4f to %.4f s, deviation %.4f s, of %zu messages", rate.rate_hz, rate.shortest_gap_s,
              rate.longest_gap_s, rate.deviation_s, rate.in_window);
  std::printf(lost > 0 ? "; %llu lost on the way\n" : "\n", static_cast<unsigned long long>(lost));
}

void report_bandwidth(const std::string& topic, const RateMeter::Rate& rate, std::uint64_t lost, bool is_json) {
  if (is_json) {
    std::cout << cdr::to_json({{"topic", topic},
                               {"bytes_per_s", rate.bytes_per_s},
                               {"mean_bytes", rate.mean_bytes},
                               {"smallest_bytes", rate.smallest_bytes},
                               {"largest_bytes", rate.largest_bytes},
                               {"window", rate.in_window},
                               {"messages", rate.messages},
                               {"lost", lost}})
              << '\n';
    return;
  }
  std::printf("%.1f kB/s, messages %.3f kB (%.3f to %.3f) of %zu messages\n", 1e-3 * rate.bytes_per_s,
              1e-3 * rate.mean_bytes, 1e-3 * static_cast<double>(rate.smallest_bytes),
              1e-3 * static_cast<double>(rate.largest_bytes), rate.in_window);
}

Status measure(const Settings& settings, const RateOptions& options, Report report) {
  using SteadyClock = std::chrono::steady_clock;
  Domain domain(settings);
  const FoundTopic topic = find_topic(domain, options.topic);
  RateMeter meter(options.window);
  const dds::RawSubscription& reader = read(domain, topic, [&](const dds::RawType::Bytes& bytes, const auto&) {
    meter.add(std::chrono::nanoseconds(SteadyClock::now().time_since_epoch()).count(), bytes.size());
  });
  const auto begin = SteadyClock::now();
  const Seconds longest(options.seconds);
  const bool has_end = options.seconds > 0.0;
  const auto left = [&] { return longest - Seconds(SteadyClock::now() - begin); };
  while (!domain.is_interrupted() && (!has_end || left() > Seconds::zero())) {
    domain.wait_until([] { return false; }, has_end ? std::min(left(), kReportPeriod) : kReportPeriod);
    const RateMeter::Rate rate = meter.rate();
    if (rate.messages > 0) report(topic.name, rate, reader.missed(), settings.is_json);
    if (rate.messages == 0 && !settings.is_json) std::puts("no message so far");
    std::cout << std::flush;
    std::fflush(stdout);
  }
  if (meter.rate().messages > 0 || !has_end) return kDone;
  throw Failure(kTooLate, topic.name + " has a publisher, but no message came");
}

void add_measurement(CLI::App& app, const Settings& settings, Job& job, const std::string& name,
                     const std::string& meaning, Report report) {
  auto options = std::make_shared<RateOptions>();
  CLI::App* command = app.add_subcommand(name, meaning);
  command->add_option("topic", options->topic, "/camera/color/image_raw")->required();
  command->add_option("--window", options->window, "number of messages over which it is measured")
      ->check(CLI::Range(2, 1'000'000))
      ->capture_default_str();
  command->add_option("--seconds", options->seconds, "end after this time [s]")->check(CLI::Range(0.0, 1e6));
  command->callback([&settings, &job, options, report] {
    job = [&settings, options, report] { return measure(settings, *options, report); };
  });
}

}  // namespace

void add_rates(CLI::App& app, const Settings& settings, Job& job) {
  add_measurement(app, settings, job, "hz", "measure how often messages come, once a second", report_rate);
  add_measurement(app, settings, job, "bw", "measure how many bytes come, once a second", report_bandwidth);
}

}  // namespace lapis::command_line
