#pragma once

#include <cstdint>

namespace lapis::dds {

/// What a topic requires of DDS. Every topic is RELIABLE and KEEP_LAST (docs/topics.md).
struct Qos {
  int depth = 10;
  bool latched = false;  ///< TRANSIENT_LOCAL: a late joiner gets the last samples
  bool keyed = false;    ///< one history per key, any number of keys
  /// History depth of readers; 0: same as depth. It is larger for a latched topic with several writers, because a
  /// reader keeps one history for all of them.
  int reader_depth = 0;
  bool urgent = false;  ///< heartbeat period 20 ms instead of 100 ms: frames, /clock, /sim/*
  bool large = false;   ///< samples of many datagrams: what they need follows the link (link.hpp)

  bool operator==(const Qos&) const = default;
};

inline constexpr Qos kImage{.depth = 5, .urgent = true, .large = true};
inline constexpr Qos kImageInfo{.depth = 30, .urgent = true};  ///< comes before its image, which takes longer
inline constexpr Qos kState{.depth = 10};
inline constexpr Qos kBurst{.depth = 100};  ///< many samples at once, such as those since the last camera frame
inline constexpr Qos kFrameState{.depth = 10, .urgent = true};  ///< one sample per camera frame
inline constexpr Qos kLatched{.depth = 1, .latched = true};
inline constexpr Qos kLatchedByMany{.depth = 1, .latched = true, .reader_depth = 100};
inline constexpr Qos kCommand{.depth = 1};
inline constexpr Qos kLockstep{.depth = 100, .urgent = true};
inline constexpr Qos kKeyedTiles{.depth = 1, .latched = true, .keyed = true, .large = true};
inline constexpr Qos kService{.depth = 100};  ///< requests wait while one is handled

inline constexpr std::int64_t kUrgentHeartbeatNs = 20'000'000;
inline constexpr std::int64_t kHeartbeatNs = 100'000'000;

}  // namespace lapis::dds
