#pragma once

#include <spdlog/sinks/base_sink.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>

namespace lapis::logging {

/// A line of the log.
struct Line {
  std::chrono::system_clock::time_point stamp;
  spdlog::level::level_enum level = spdlog::level::info;
  std::string text;
  std::string file;  ///< file, function and line are known only where a macro of spdlog logs
  std::string function;
  std::uint32_t line = 0;
};

/// Keeps what is logged until somebody takes it. Whoever logs never waits for that: from the kMost-th line on the
/// oldest one makes room.
class LineQueue : public spdlog::sinks::base_sink<std::mutex> {
 public:
  static constexpr std::size_t kMost = 1000;

  /// All lines that have not been taken, oldest first; waits for the first one. Empty: the queue is closed.
  std::deque<Line> take();
  /// Nothing is kept from now on; take() returns what is left.
  void close();

 private:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override {}

  std::condition_variable changed_;
  std::deque<Line> lines_;
  bool is_closed_ = false;
};

}  // namespace lapis::logging
