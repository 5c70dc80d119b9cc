#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace lapis::bags {

/// A topic of a bag, with all that is needed to read its messages and to publish them again.
struct Channel {
  std::string topic;             ///< ROS name, "/camera/color/image_raw"
  std::string type;              ///< ROS name, "sensor_msgs/msg/Image"
  std::string encoding = "cdr";  ///< of the messages
  std::string schema_encoding = "ros2msg";
  std::string schema;       ///< declaration of the type with all dependencies
  std::string type_hash;    ///< "RIHS01_...", or empty: not known
  std::string offered_qos;  ///< YAML list of the writers' QoS profiles, as rosbag2 writes it, or empty

  bool operator==(const Channel&) const = default;
};

/// A message as it was received. Times are nanoseconds since the epoch of the clock that the recorder used.
struct Message {
  std::size_t channel = 0;  ///< index in the list of channels
  std::uint32_t sequence = 0;
  std::int64_t log_time_ns = 0;      ///< when it was received
  std::int64_t publish_time_ns = 0;  ///< when it was sent; log_time_ns where that is not known
  std::vector<std::uint8_t> data;    ///< with the encapsulation header of CDR (4 bytes)
};

/// Writes one file of a bag. Every function throws std::runtime_error, which names the file, when it cannot be written.
class StorageWriter {
 public:
  virtual ~StorageWriter() = default;
  /// Adds a channel; the first one has the index 0.
  virtual std::size_t add_channel(const Channel& channel) = 0;
  virtual void write(const Message& message) = 0;
  /// After it, a kill of the process loses nothing that was written so far.
  virtual void flush() = 0;
  /// Completes the file; nothing may be written any more.
  virtual void close() = 0;
  /// Size of the file, with what is not flushed yet [bytes, before compression].
  virtual std::uint64_t bytes() const = 0;
};

/// What a file or a folder contains.
struct Contents {
  std::vector<Channel> channels;
  std::vector<std::uint64_t> message_counts;  ///< of each channel
  std::int64_t first_ns = 0, last_ns = 0;     ///< log times of the first and the last message, if there is any
  std::vector<std::string> notes;             ///< what is wrong with the files, but does not keep them from being read

  std::uint64_t message_count() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : message_counts) sum += count;
    return sum;
  }
};

/// Which messages are to be read.
struct Selection {
  std::optional<std::set<std::string>> topics;  ///< nothing: all
  std::optional<std::int64_t> from_ns, to_ns;   ///< log times, both inclusive
};

/// Reads one file of a bag, or several as one.
class StorageReader {
 public:
  virtual ~StorageReader() = default;
  virtual const Contents& contents() const = 0;
  /// Starts again with the first message of the selection.
  virtual void select(const Selection& selection) = 0;
  /// The next message in the order of log times, and of the file where these are equal; nothing at the end. Throws
  /// std::runtime_error, which names the file, where it is damaged; reading may go on after it.
  virtual std::optional<Message> next() = 0;
};

}  // namespace lapis::bags
