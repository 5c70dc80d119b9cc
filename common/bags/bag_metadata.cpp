#include "common/bags/bag_metadata.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

namespace lapis::bags {
namespace {

constexpr const char* kRoot = "rosbag2_bagfile_information";

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string text_or_empty(const YAML::Node& node) { return node && node.IsScalar() ? node.as<std::string>() : ""; }

void put_time(YAML::Emitter& out, const char* key, const char* unit, std::int64_t ns) {
  out << YAML::Key << key << YAML::BeginMap << YAML::Key << unit << YAML::Value << ns << YAML::EndMap;
}

void put_topic(YAML::Emitter& out, const Channel& channel, std::uint64_t count) {
  out << YAML::BeginMap << YAML::Key << "topic_metadata" << YAML::BeginMap;
  out << YAML::Key << "name" << YAML::Value << channel.topic;
  out << YAML::Key << "type" << YAML::Value << channel.type;
  out << YAML::Key << "serialization_format" << YAML::Value << channel.encoding;
  out << YAML::Key << "offered_qos_profiles" << YAML::Value << YAML::DoubleQuoted << channel.offered_qos;
  out << YAML::Key << "type_description_hash" << YAML::Value << YAML::DoubleQuoted << channel.type_hash;
  out << YAML::EndMap << YAML::Key << "message_count" << YAML::Value << count << YAML::EndMap;
}

void put_file(YAML::Emitter& out, const FileSummary& file) {
  out << YAML::BeginMap << YAML::Key << "path" << YAML::Value << file.name;
  put_time(out, "starting_time", "nanoseconds_since_epoch", file.first_ns);
  put_time(out, "duration", "nanoseconds", file.last_ns - file.first_ns);
  out << YAML::Key << "message_count" << YAML::Value << file.messages << YAML::EndMap;
}

}  // namespace

BagMetadata read_metadata(const std::filesystem::path& file) {
  BagMetadata metadata;
  try {
    const YAML::Node root = YAML::LoadFile(file.string())[kRoot];
    if (!root || !root.IsMap()) throw std::runtime_error(std::string("has no key '") + kRoot + "'");
    metadata.storage = text_or_empty(root["storage_identifier"]);
    metadata.compression_format = lower(text_or_empty(root["compression_format"]));
    metadata.compression_mode = lower(text_or_empty(root["compression_mode"]));
    const YAML::Node files = root["relative_file_paths"];
    if (!files || !files.IsSequence()) throw std::runtime_error("has no list 'relative_file_paths'");
    for (const YAML::Node& path : files) metadata.files.push_back(path.as<std::string>());
  } catch (const YAML::BadFile&) {
    throw std::runtime_error(file.string() + ": cannot be read");
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
  return metadata;
}

std::string format_metadata(const std::string& storage, const Contents& contents,
                            const std::vector<FileSummary>& files) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << kRoot << YAML::BeginMap;
  out << YAML::Key << "version" << YAML::Value << 8;
  out << YAML::Key << "storage_identifier" << YAML::Value << storage;
  put_time(out, "duration", "nanoseconds", contents.last_ns - contents.first_ns);
  put_time(out, "starting_time", "nanoseconds_since_epoch", contents.first_ns);
  out << YAML::Key << "message_count" << YAML::Value << contents.message_count();
  out << YAML::Key << "topics_with_message_count" << YAML::BeginSeq;
  for (std::size_t i = 0; i < contents.channels.size(); ++i) {
    put_topic(out, contents.channels[i], contents.message_counts[i]);
  }
  out << YAML::EndSeq;
  out << YAML::Key << "compression_format" << YAML::Value << YAML::DoubleQuoted << "";
  out << YAML::Key << "compression_mode" << YAML::Value << YAML::DoubleQuoted << "";
  out << YAML::Key << "relative_file_paths" << YAML::BeginSeq;
  for (const FileSummary& file : files) out << file.name;
  out << YAML::EndSeq << YAML::Key << "files" << YAML::BeginSeq;
  for (const FileSummary& file : files) put_file(out, file);
  out << YAML::EndSeq << YAML::Key << "custom_data" << YAML::Value << YAML::Null;
  out << YAML::Key << "ros_distro" << YAML::Value << "jazzy";
  out << YAML::EndMap << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

}  // namespace lapis::bags
