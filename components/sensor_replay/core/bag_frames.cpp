#include "sensor_replay/core/bag_frames.hpp"

#include <algorithm>
#include <utility>

#include "common/bags/leading_stamp.hpp"

namespace lapis::sensor_replay {
BagFrames::BagFrames(bags::StorageReader& reader, std::vector<std::optional<Role>> roles)
    : reader_(reader), roles_(std::move(roles)), newest_(roles_.size()) {}

bool BagFrames::read_more() {
  while (auto message = is_at_end_ ? std::nullopt : reader_.next()) {
    read_ns_ = std::max(read_ns_, message->log_time_ns);
    if (!roles_[message->channel]) continue;
    const auto stamp = bags::leading_stamp(message->data);
    if (!stamp) {
      ++unreadable_;
      continue;
    }
    auto& newest = newest_[message->channel];
    newest = std::max(newest.value_or(*stamp), *stamp);
    waiting_.push_back({*stamp, std::move(*message)});
    return true;
  }
  is_at_end_ = true;
  return false;
}

const BagFrames::Stamped* BagFrames::color(std::size_t n) const {
  for (const Stamped& waiting : waiting_) {
    if (roles_[waiting.message.channel] == Role::kColor && n-- == 0) return &waiting;
  }
  return nullptr;
}

/// Up to which stamp messages belong to the frame of a colour image, which is the first one that waits.
time::Time BagFrames::end_of(const Stamped& color, Role role) const {
  const Stamped* following = this->color(1);
  if (role == Role::kOther || following == nullptr) return color.stamp;
  return {color.stamp.nanoseconds + (following->stamp.nanoseconds - color.stamp.nanoseconds - 1) / 2};
}

/// Whether nothing of a channel that belongs to the frame can come any more, if its stamps increase.
bool BagFrames::has_seen_all_of(std::size_t channel, const Stamped& color) const {
  if (!newest_[channel]) return false;
  if (*roles_[channel] == Role::kOther) return *newest_[channel] > color.stamp;
  const bool has_exact = std::any_of(waiting_.begin(), waiting_.end(), [&](const Stamped& waiting) {
    return waiting.message.channel == channel && waiting.stamp == color.stamp;
  });
  return has_exact || (this->color(1) != nullptr && *newest_[channel] > end_of(color, Role::kPart));
}

bool BagFrames::is_complete(const Stamped& color) const {
  if (read_ns_ - color.message.log_time_ns > static_cast<std::int64_t>(kLookahead_s * 1e9)) return true;
  for (std::size_t channel = 0; channel < roles_.size(); ++channel) {
    if (roles_[channel] && roles_[channel] != Role::kColor && !has_seen_all_of(channel, color)) return false;
  }
  return true;
}

std::optional<BagFrames::Frame> BagFrames::next() {
  while ((color(0) == nullptr || !is_complete(*color(0))) && read_more()) {
  }
  const Stamped* first = color(0);
  if (first == nullptr) return std::nullopt;
  const Stamped color = *first;
  const time::Time parts_end = end_of(color, Role::kPart);
  std::vector<Stamped> chosen;
  std::erase_if(waiting_, [&](Stamped& waiting) {
    const Role role = *roles_[waiting.message.channel];
    if (role == Role::kColor ? waiting.stamp != color.stamp
                             : waiting.stamp > (role == Role::kPart ? parts_end : color.stamp)) {
      return false;
    }
    chosen.push_back(std::move(waiting));
    return true;
  });
  std::stable_sort(chosen.begin(), chosen.end(), [&](const Stamped& a, const Stamped& b) {
    const bool is_color_a = roles_[a.message.channel] == Role::kColor;
    const bool is_color_b = roles_[b.message.channel] == Role::kColor;
    if (is_color_a != is_color_b) return is_color_b;
    return std::pair(a.stamp, a.message.channel) < std::pair(b.stamp, b.message.channel);
  });
  Frame frame{color.stamp, {}};
  for (Stamped& part : chosen) frame.messages.push_back(std::move(part.message));
  return frame;
}

}  // namespace lapis::sensor_replay
