#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <utility>

namespace lapis::slam {

/// Result of a job in a separate thread. It is due at a fixed frame, however long the job takes, so that runs are the
/// same on fast and on slow machines.
template <class Result>
class DueResult {
 public:
  bool is_busy() const { return result_.valid(); }
  /// Starts the job; its result is due at frame number `due`. Not allowed while busy.
  void start(std::uint64_t due, std::function<Result()> job) {
    due_ = due;
    result_ = std::async(std::launch::async, std::move(job));
  }
  /// The result once it is due; waits for it if necessary. Nothing before, and while no job was started.
  std::optional<Result> take(std::uint64_t frame) {
    if (!is_busy() || frame < due_) return std::nullopt;
    return result_.get();
  }

 private:
  std::future<Result> result_;
  std::uint64_t due_ = 0;
};

}  // namespace lapis::slam
