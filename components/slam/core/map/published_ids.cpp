#include "slam/core/map/published_ids.hpp"

#include <algorithm>

namespace lapis::slam {

std::uint64_t PublishedIds::of(std::uint64_t index) const {
  const auto after = std::upper_bound(stretches.begin(), stretches.end(), index,
                                      [](std::uint64_t i, const Stretch& stretch) { return i < stretch.index; });
  if (after == stretches.begin()) return index;
  const Stretch& stretch = *(after - 1);
  return stretch.id + (index - stretch.index);
}

void PublishedIds::skip(std::uint64_t next_index) {
  const std::uint64_t id = of(next_index) + kSkipped;
  if (!stretches.empty() && stretches.back().index == next_index) stretches.pop_back();
  stretches.push_back({next_index, id});
}

bool PublishedIds::are_sound() const {
  Stretch before;
  for (const Stretch& stretch : stretches) {
    const bool is_later = stretch.index >= before.index && stretch.id >= before.id;
    if (!is_later || stretch.id >= kEnd || stretch.id - before.id < stretch.index - before.index) return false;
    before = stretch;
  }
  return true;
}

}  // namespace lapis::slam
