#pragma once

#include <cstdint>
#include <vector>

namespace lapis::slam {

/// Ids under which the key-frames of a map are published. Within the map an id is an index. A map that is resumed
/// within a run is an older save of itself, and other processes know key-frames that came after that save: the ids of
/// new ones begin beyond all that can have been published, so that no id means two things.
class PublishedIds {
 public:
  /// More key-frames than slam can add between two saves: at 30 Hz it would take nine hours.
  static constexpr std::uint64_t kSkipped = 1'000'000;
  /// Limit of the ids: the observers of landmarks are published with 32 bits.
  static constexpr std::uint64_t kEnd = std::uint64_t{1} << 32;

  /// From this index on ids grow by one, beginning at `id`.
  struct Stretch {
    std::uint64_t index = 0;
    std::uint64_t id = 0;

    bool operator==(const Stretch&) const = default;
  };

  std::uint64_t of(std::uint64_t index) const;
  /// Leaves out kSkipped ids before the one of `next_index`, the index of the next new key-frame.
  void skip(std::uint64_t next_index);
  /// Whether stretches from a file are in order, do not overlap and stay below kEnd.
  bool are_sound() const;

  std::vector<Stretch> stretches;  ///< by index; before the first one the id is the index
};

}  // namespace lapis::slam
