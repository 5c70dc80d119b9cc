#include "recorder/recording_worker.hpp"

#include <chrono>
#include <utility>

namespace lapis::recorder {
namespace {

constexpr std::chrono::seconds kFlushPeriod{1};

}  // namespace

RecordingWorker::RecordingWorker(const std::filesystem::path& folder, const bags::BagOptions& options,
                                 std::uint64_t most_bytes)
    : writer_(folder, options), most_bytes_(most_bytes), thread_([this] { run(); }) {}

RecordingWorker::~RecordingWorker() { close(); }

std::size_t RecordingWorker::add_channel(const bags::Channel& channel) {
  const std::lock_guard lock(mutex_);
  jobs_.emplace_back(channel);
  return channels_++;
}

bool RecordingWorker::write(bags::Message message, bool waits) {
  std::unique_lock lock(mutex_);
  const auto has_room = [&] { return waiting_bytes_ == 0 || waiting_bytes_ + message.data.size() <= most_bytes_; };
  if (waits) changed_.wait(lock, [&] { return failure_ || has_room(); });
  if (failure_ || !has_room()) return false;
  waiting_bytes_ += message.data.size();
  jobs_.emplace_back(std::move(message));
  lock.unlock();
  changed_.notify_all();
  return true;
}

void RecordingWorker::close() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

std::optional<std::string> RecordingWorker::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

std::uint64_t RecordingWorker::written() const {
  const std::lock_guard lock(mutex_);
  return written_;
}

void RecordingWorker::run() {
  auto flushed = std::chrono::steady_clock::now();
  for (bool is_last = false; !is_last;) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kFlushPeriod, [&] { return is_ending_ || !jobs_.empty(); });
    is_last = is_ending_;
    std::deque<Job> jobs = std::exchange(jobs_, {});
    lock.unlock();
    try {
      work(std::move(jobs), is_last);
      const auto now = std::chrono::steady_clock::now();
      if (!is_last && now - flushed >= kFlushPeriod) {
        writer_.flush();
        flushed = now;
      }
    } catch (const std::exception& error) {
      const std::lock_guard failed(mutex_);
      failure_ = error.what();
      is_last = true;
    }
    changed_.notify_all();
  }
}

void RecordingWorker::work(std::deque<Job> jobs, bool is_last) {
  for (const Job& job : jobs) {
    if (const auto* channel = std::get_if<bags::Channel>(&job)) {
      writer_.add_channel(*channel);
      continue;
    }
    const auto& message = std::get<bags::Message>(job);
    writer_.write(message);
    const std::lock_guard lock(mutex_);
    waiting_bytes_ -= message.data.size();
    ++written_;
  }
  if (is_last) writer_.close();
}

}  // namespace lapis::recorder
