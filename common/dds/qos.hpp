#pragma once

#include <cstdint>

namespace lapis::dds {

/// What a topic requires of DDS. Every topic is KEEP_LAST, and RELIABLE unless it says otherwise (docs/topics.md).
struct Qos {
  int depth = 10;
  bool latched = false;  ///< TRANSIENT_LOCAL: a late joiner gets the last samples
  bool keyed = false;    ///< one history per key, any number of keys
  /// History depth of readers; 0: same as depth. It is larger for a latched topic with several writers, because a
  /// reader keeps one history for all of them.
  int reader_depth = 0;
  bool urgent = false;  ///< heartbeat period 20 ms instead of 100 ms: frames, /clock, /sim/*
  bool large = false;   ///< samples of many datagrams: what they need follows the link (link.hpp)
  bool sensor = false;  ///< drivers of others publish it, some of them BEST_EFFORT: readers follow (SensorQos)
  bool best_effort = false;
  int lifespan_s = 0;  ///< age from which a late joiner no longer gets a sample; 0: any age

  bool operator==(const Qos&) const = default;
};

inline constexpr Qos kImage{.depth = 5, .urgent = true, .large = true, .sensor = true};
inline constexpr Qos kImageInfo{.depth = 30, .urgent = true, .sensor = true};  ///< comes before its image
inline constexpr Qos kState{.depth = 10};
inline constexpr Qos kBurst{.depth = 100};  ///< many samples at once, such as those since the last camera frame
inline constexpr Qos kSensorBurst{.depth = 100, .sensor = true};
inline constexpr Qos kFrameState{.depth = 10, .urgent = true};  ///< one sample per camera frame
inline constexpr Qos kLatched{.depth = 1, .latched = true};
inline constexpr Qos kLatchedByMany{.depth = 1, .latched = true, .reader_depth = 100};
inline constexpr Qos kCommand{.depth = 1};
inline constexpr Qos kLockstep{.depth = 100, .urgent = true};
inline constexpr Qos kKeyedTiles{.depth = 1, .latched = true, .keyed = true, .large = true};
inline constexpr Qos kNodeEvent{.depth = 1000};                               ///< as rcl has it for /parameter_events
inline constexpr Qos kLog{.depth = 1000, .latched = true, .lifespan_s = 10};  ///< as rcl has it for /rosout
inline constexpr Qos kService{.depth = 100};                                  ///< requests wait while one is handled

/// How sensor topics are read and written. A BEST_EFFORT reader hears every writer and a RELIABLE one only reliable
/// writers, but only the latter gets what is lost on a network sent again.
enum class SensorQos {
  kAuto,       ///< RELIABLE; readers only until a writer of the topic offers less
  kReliable,   ///< RELIABLE
  kBestEffort  ///< BEST_EFFORT
};

inline constexpr std::int64_t kUrgentHeartbeatNs = 20'000'000;
inline constexpr std::int64_t kHeartbeatNs = 100'000'000;

}  // namespace lapis::dds
