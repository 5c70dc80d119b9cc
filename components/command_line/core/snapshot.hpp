#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "command_line/core/graph.hpp"

namespace lapis::command_line {

/// What has come on a topic while it was watched.
struct SeenStream {
  std::string topic = {};
  std::uint64_t messages = 0;
  std::uint64_t lost = 0;                    ///< gaps in the sequence numbers of its writers
  std::vector<std::int64_t> stamps_ns = {};  ///< of the headers, in order of arrival
  double delay_s = 0.0;                      ///< median time from stamp to arrival, by this machine's clock
  double rate_hz = 0.0;                      ///< of arrival; 0 with fewer than two messages
  std::string frame = {};                    ///< of the newest message
  int width = 0, height = 0;                 ///< of images that are not compressed [px]
  std::string encoding = {};                 ///< of images
};

/// The newest camera info of a camera.
struct SeenCameraInfo {
  std::string frame = {};
  int width = 0, height = 0;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
  std::string distortion_model = {};
};

/// One of the camera's image streams with all that belongs to it.
struct SeenCamera {
  std::string what = {};                              ///< "colour", "depth"
  std::string raw_topic = {}, compressed_topic = {};  ///< as this domain calls them
  std::string info_topic = {};
  std::string compressed_setting = {};         ///< "dds.color_transport=compressed"
  std::vector<std::string> encodings = {};     ///< that Lapis reads
  std::optional<SeenStream> images = {};       ///< of the one that is published; raw, if both are
  std::optional<SeenStream> info_stream = {};  ///< nothing: nobody publishes it
  std::optional<SeenCameraInfo> info = {};
};

struct SeenTransform {
  std::string parent = {}, child = {};
};

/// A topic that Lapis knows, and what it asks of its writers.
struct KnownTopic {
  std::string name = {};  ///< as this domain calls it
  std::string type = {};
  bool is_latched = false;
  bool has_many_writers = false;
};

/// What doctor has seen of a domain and of this machine.
struct Snapshot {
  int domain = 0;
  std::string range = {};  ///< "SUBNET", "LOCALHOST" or "OFF"
  double seconds = 0.0;    ///< for which it was watched
  std::size_t participants = 0;
  std::vector<std::string> nodes = {};
  std::vector<SeenEndpoint> endpoints = {};
  std::vector<std::string> runs = {};  ///< of Lapis, that take part
  SeenCamera color = {}, depth = {};
  std::map<std::string, SeenStream> others = {};  ///< by name: topics of the robot that are published
  std::optional<SeenStream> static_transforms_stream = {};
  std::vector<SeenTransform> static_transforms = {};
  std::string static_transforms_topic = {}, base_frame = {}, labels_topic = {}, label_info_topic = {};
  std::optional<std::int64_t> clock_ns = {};  ///< newest time on /clock
  std::int64_t system_ns = 0;                 ///< this machine's clock when the newest images came
  std::vector<KnownTopic> known_topics = {};
  std::map<std::string, std::string> known_hashes = {};  ///< type hashes of this build by type
  int socket_buffer_bytes = 0;                           ///< that the kernel grants
  int wanted_socket_buffer_bytes = 0;
  bool has_network_interface = true;
};

}  // namespace lapis::command_line
