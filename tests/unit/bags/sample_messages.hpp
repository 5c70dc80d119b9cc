#pragma once

#include <filesystem>
#include <fstream>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "common/bags/bag.hpp"

namespace lapis::bags::test {

inline Channel sample_channel(const std::string& topic, const std::string& type = "std_msgs/msg/String") {
  return {.topic = topic,
          .type = type,
          .encoding = "cdr",
          .schema_encoding = "ros2msg",
          .schema = "string data\n",
          .type_hash = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
          .offered_qos = "- history: 1\n  depth: 10\n"};
}

/// `count` messages in turn on `channels` channels, 1 ms apart, of up to `most` random bytes.
inline std::vector<Message> sample_messages(std::size_t count, std::size_t channels, std::size_t most = 200) {
  std::mt19937 random(1);
  std::vector<Message> messages;
  for (std::size_t i = 0; i < count; ++i) {
    const auto time_ns = static_cast<std::int64_t>(1'700'000'000'000'000'000 + 1'000'000 * i);
    Message message{i % channels, static_cast<std::uint32_t>(i / channels), time_ns, time_ns - 500, {0, 1, 0, 0}};
    const std::size_t size = random() % (most + 1);
    for (std::size_t byte = 0; byte < size; ++byte) message.data.push_back(static_cast<std::uint8_t>(random()));
    messages.push_back(std::move(message));
  }
  return messages;
}

inline std::vector<Message> read_all(StorageReader& reader) {
  std::vector<Message> messages;
  while (auto message = reader.next()) messages.push_back(std::move(*message));
  return messages;
}

/// Without flushing to the disk.
inline void write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// Whether two messages are the same but for what SQLite does not keep.
inline bool is_same(const Message& a, const Message& b) {
  return a.channel == b.channel && a.log_time_ns == b.log_time_ns && a.data == b.data;
}

}  // namespace lapis::bags::test
