#pragma once

#include <string>

#include "common/config/schema.hpp"

namespace lapis::recorder {

struct RecorderConfig {
  std::string output;
  std::string storage = "mcap";
  std::string time = "system";
  config::Words topics;
  config::Words exclude;
  int compression_level = 1;
  int split_mb = 0;
  double split_s = 0.0;
  double snapshot_s = 0.0;
  int memory_mb = 512;
};

template <class Field>
void describe(Field& field, RecorderConfig& c) {
  field("output", c.output, config::anything(), "folder of the bag; it must not exist, or be empty");
  field("storage", c.storage, config::one_of({"mcap", "sqlite3"}), "how messages are stored");
  field("time", c.time, config::one_of({"system", "clock"}),
        "when a message was received: by the system's clock, or by /clock, as for replays and simulators; then what "
        "comes "
        "before the first /clock gets its time");
  field("topics", c.topics, config::anything(),
        "names of the topics that are recorded, with namespace; * stands for any text; empty: all topics of ROS 2 that "
        "anybody publishes");
  field("exclude", c.exclude, config::anything(), "names of topics that are not recorded, as for topics");
  field("compression_level", c.compression_level, config::in_range(0, 19), "of zstd, for mcap; 0: none");
  field("split_mb", c.split_mb, config::in_range(0, 1'000'000),
        "size at which a new file of the bag begins, before compression; 0: never [MB]");
  field("split_s", c.split_s, config::in_range(0.0, 1e6),
        "time after which a new file of the bag begins; 0: never [s]");
  field("snapshot_s", c.snapshot_s, config::in_range(0.0, 3600.0),
        "above 0: nothing is written, but the last seconds are kept in memory, and /recorder/snapshot writes them as a "
        "bag into the folder [s]");
  field("memory_mb", c.memory_mb, config::in_range(1, 1'000'000),
        "most memory for messages that wait for the disk, or of a snapshot; messages that find no room are lost and "
        "counted; lock-step waits [MB]");
}

}  // namespace lapis::recorder
