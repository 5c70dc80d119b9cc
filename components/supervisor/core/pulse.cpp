#include "supervisor/core/pulse.hpp"

#include <algorithm>

namespace lapis::supervisor {

void Pulse::hear(double now_s, const Beat& beat) {
  if (asked_s_ && newest_ && newest_->silence_s > 0.0) asked_s_ = now_s;  // it could not listen to the request before
  newest_ = beat;
  heard_s_ = now_s;
}

void Pulse::ask_to_end(double now_s) {
  if (!asked_s_) asked_s_ = now_s;
}

void Pulse::forgive(double now_s) {
  heard_s_ = now_s;
  if (asked_s_) asked_s_ = now_s;
}

bool Pulse::is_hung(double now_s, double usual_s) const {
  const double announced_s = newest_ ? newest_->silence_s : kStart_s;
  if (asked_s_) return now_s > std::max(*asked_s_ + usual_s, heard_s_ + announced_s);
  return silence_s(now_s) > std::max(usual_s, announced_s);
}

}  // namespace lapis::supervisor
