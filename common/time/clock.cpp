#include "common/time/clock.hpp"

#include <chrono>

namespace lapis::time {

Time Clock::now() const {
  if (kind_ == Kind::kSimulated) return simulated_;
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch).count()};
}

}  // namespace lapis::time
