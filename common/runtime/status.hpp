#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace lapis::runtime {

/// Status of a component, which is published on /diagnostics.
class Status {
 public:
  static constexpr std::size_t kMostCounters = 100;
  static constexpr std::size_t kLongestKey = 200;
  static constexpr const char* kOtherCounters = "other counters";

  enum class Level { kOk = 0, kWarn = 1, kError = 2 };

  void set(Level level, const std::string& message) {
    has_changed_ |= level != level_;
    level_ = level;
    message_ = message;
  }
  void value(const std::string& key, const std::string& text) { values_[key] = text; }
  void value(const std::string& key, std::uint64_t number) { values_[key] = std::to_string(number); }
  /// Adds to a counter, for example of dropped input; the key says what is counted and why. Keys may quote what others
  /// send: they are cut to kLongestKey bytes, and from the kMostCounters-th on all new ones share one counter.
  void count(const std::string& key, std::uint64_t more = 1) {
    const std::string name = key.substr(0, kLongestKey);
    const bool has_place = counters_.contains(name) || counters_.size() + 1 < kMostCounters;
    counters_[has_place ? name : kOtherCounters] += more;
  }
  std::uint64_t counter(const std::string& key) const {
    const auto it = counters_.find(key.substr(0, kLongestKey));
    return it == counters_.end() ? 0 : it->second;
  }

  Level level() const { return level_; }
  const std::string& message() const { return message_; }
  const std::map<std::string, std::string>& values() const { return values_; }
  const std::map<std::string, std::uint64_t>& counters() const { return counters_; }
  /// True once after a change of the level.
  bool take_change() { return std::exchange(has_changed_, false); }

 private:
  Level level_ = Level::kOk;
  std::string message_ = "running";
  std::map<std::string, std::string> values_;
  std::map<std::string, std::uint64_t> counters_;
  bool has_changed_ = false;
};

}  // namespace lapis::runtime
