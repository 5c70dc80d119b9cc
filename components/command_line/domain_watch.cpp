#include "command_line/domain_watch.hpp"

#include <algorithm>
#include <chrono>

#include "common/cdr/decode.hpp"
#include "common/dds/host_addresses.hpp"
#include "common/topics.hpp"
#include "idl/type_table.hpp"

namespace lapis::command_line {
namespace {

constexpr int kWatchDepth = 200;  // images that wait while others are looked at
constexpr const char* kImageType = "sensor_msgs/msg/Image";
constexpr const char* kCompressedType = "sensor_msgs/msg/CompressedImage";
constexpr const char* kInfoType = "sensor_msgs/msg/CameraInfo";
constexpr const char* kTransformsType = "tf2_msgs/msg/TFMessage";
constexpr const char* kClockType = "rosgraph_msgs/msg/Clock";

/// The encodings that slam reads (common/messages/camera.hpp).
const std::vector<std::string> kColorEncodings{"rgb8",   "bgr8",  "rgba8",  "bgra8", "mono8", "8UC1",
                                               "mono16", "16UC1", "yuv422", "uyvy",  "yuyv",  "yuv422_yuy2"};
const std::vector<std::string> kDepthEncodings{"16UC1", "32FC1", "mono16"};

std::int64_t nanoseconds_of(const cdr::Value& stamp) {
  return stamp["sec"].get<std::int64_t>() * 1'000'000'000 + stamp["nanosec"].get<std::int64_t>();
}

SeenCameraInfo to_info(const cdr::Value& message) {
  const cdr::Value& k = message["k"];
  return {.frame = message["header"]["frame_id"],
          .width = message["width"],
          .height = message["height"],
          .fx = k[0],
          .fy = k[4],
          .cx = k[2],
          .cy = k[5],
          .distortion_model = message["distortion_model"]};
}

std::string range_text(const dds::DiscoverySettings& settings) {
  switch (settings.range) {
    case dds::DiscoveryRange::kSubnet: return "SUBNET";
    case dds::DiscoveryRange::kLocalhost: return "LOCALHOST";
    case dds::DiscoveryRange::kOff: return "OFF";
  }
  return "";
}

template <class Message>
std::string name_of(const Domain& domain, const dds::Topic<Message>& topic) {
  return domain.names().full(topic.name, topic.is_global);
}

std::vector<KnownTopic> known_topics(const Domain& domain) {
  std::vector<KnownTopic> known;
  topics::for_each([&](const auto& topic) {
    using Support = idl::TypeSupport<typename std::decay_t<decltype(topic)>::Type>;
    known.push_back({name_of(domain, topic), Support::kRosName, topic.qos.latched, topic.has_many_writers});
  });
  return known;
}

std::map<std::string, std::string> known_hashes() {
  std::map<std::string, std::string> known;
  for (const idl::TypeEntry& entry : idl::type_table()) known[std::string(entry.ros_name)] = std::string(entry.hash);
  return known;
}

/// The runs to which endpoints belong, sorted.
std::vector<std::string> runs_of(const std::vector<SeenEndpoint>& endpoints) {
  std::set<std::string> runs;
  for (const SeenEndpoint& endpoint : endpoints) runs.insert(endpoint.run);
  runs.erase("");
  return {runs.begin(), runs.end()};
}

}  // namespace

DomainWatch::DomainWatch(Domain& domain) : domain_(domain) {}

std::vector<std::string> DomainWatch::watched_topics() const {
  const auto name = [this](const auto& topic) { return name_of(domain_, topic); };
  return {name(topics::kColor),
          name(topics::kCompressedColor),
          name(topics::kDepth),
          name(topics::kCompressedDepth),
          name(topics::kColorInfo),
          name(topics::kDepthInfo),
          name(topics::kStaticTransforms),
          name(topics::kClock),
          name(topics::kLabels),
          name(topics::kWheelOdometry),
          name(topics::kImu)};
}

void DomainWatch::watch(Seconds duration) {
  follow();
  domain_.settle();
  follow();
  is_counting_ = true;
  const auto begin = std::chrono::steady_clock::now();
  std::uint64_t version = 0;
  domain_.wait_until(
      [&] {
        const std::uint64_t now = domain_.participant().endpoints().version();
        if (now != version) follow();
        version = now;
        return false;
      },
      duration);
  seconds_ = Seconds(std::chrono::steady_clock::now() - begin).count();
}

void DomainWatch::follow() {
  for (const std::string& topic : watched_topics()) read_when_published(topic);
}

void DomainWatch::read_when_published(const std::string& topic) {
  if (watched_.contains(topic)) return;
  std::vector<dds::Endpoint> writers = domain_.endpoints();
  std::erase_if(writers, [&](const dds::Endpoint& endpoint) {
    return !endpoint.is_writer || endpoint.is_keyed || endpoint.topic != dds::topic_dds_name(topic);
  });
  if (writers.empty()) return;
  const dds::Endpoint& first = writers.front();
  const std::string type = dds::ros_type_name(first.type);
  const idl::TypeEntry* entry = idl::find(type);
  if (entry == nullptr) return;
  Watched& watched = watched_[topic];
  watched.stream.topic = topic;
  watched.type = type;
  watched.layout = cdr::parse_ros2msg(entry->ros_name, entry->ros2msg_text);
  dds::Qos qos{.depth = kWatchDepth, .reader_depth = kWatchDepth, .large = type == kImageType};
  qos.best_effort = !std::ranges::all_of(writers, &dds::Endpoint::is_reliable);
  qos.latched = std::ranges::all_of(writers, &dds::Endpoint::is_latched);
  watched.reader = &domain_.add<dds::RawSubscription>(
      first.topic, first.type, dds::type_hash_of(first), qos,
      [this, &watched](const dds::RawType::Bytes& bytes, const auto&) { note(watched, bytes); });
  domain_.participant().announce_graph();
}

void DomainWatch::note(Watched& watched, const dds::RawType::Bytes& bytes) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  ++watched.stream.messages;
  if (is_counting_) watched.meter.add(std::chrono::nanoseconds(now).count(), bytes.size());
  try {
    note_message(watched, cdr::decode(watched.layout, bytes, "data"));  // pixels are not looked at
  } catch (const std::runtime_error&) {
    // Another declaration of the type, which the type hash says.
  }
}

void DomainWatch::note_message(Watched& watched, const cdr::Value& message) {
  SeenStream& stream = watched.stream;
  if (const auto header = message.find("header"); header != message.end()) {
    stream.frame = (*header)["frame_id"];
    stream.stamps_ns.push_back(nanoseconds_of((*header)["stamp"]));
    system_ns_ = std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
    watched.delays_s.push_back(1e-9 * static_cast<double>(system_ns_ - stream.stamps_ns.back()));
  }
  if (watched.type == kImageType) {
    stream.width = message["width"];
    stream.height = message["height"];
    stream.encoding = message["encoding"];
  } else if (watched.type == kCompressedType) {
    stream.encoding = message["format"];
  } else if (watched.type == kInfoType) {
    infos_[stream.topic] = to_info(message);
  } else if (watched.type == kClockType) {
    clock_ns_ = std::max(clock_ns_.value_or(0), nanoseconds_of(message["clock"]));
  } else if (watched.type == kTransformsType) {
    for (const cdr::Value& transform : message["transforms"]) {
      static_transforms_.push_back({transform["header"]["frame_id"], transform["child_frame_id"]});
    }
  }
}

SeenStream DomainWatch::finished(const Watched& watched) const {
  SeenStream stream = watched.stream;
  stream.lost = watched.reader->missed();
  stream.rate_hz = watched.meter.rate().rate_hz;
  if (watched.delays_s.empty()) return stream;
  std::vector<double> delays_s = watched.delays_s;
  const auto middle = delays_s.begin() + static_cast<std::ptrdiff_t>(delays_s.size() / 2);
  std::ranges::nth_element(delays_s, middle);
  stream.delay_s = *middle;
  return stream;
}

const DomainWatch::Watched* DomainWatch::find(const std::string& topic) const {
  const auto found = watched_.find(topic);
  return found == watched_.end() ? nullptr : &found->second;
}

SeenCamera DomainWatch::camera(const std::string& what) const {
  const bool is_depth = what == "depth";
  SeenCamera camera{
      .what = what,
      .raw_topic = name_of(domain_, is_depth ? topics::kDepth : topics::kColor),
      .compressed_topic = name_of(domain_, is_depth ? topics::kCompressedDepth : topics::kCompressedColor),
      .info_topic = name_of(domain_, is_depth ? topics::kDepthInfo : topics::kColorInfo),
      .compressed_setting = is_depth ? "dds.depth_transport=compressed" : "dds.color_transport=compressed",
      .encodings = is_depth ? kDepthEncodings : kColorEncodings,
      .images = {},
      .info_stream = {},
      .info = {}};
  for (const std::string& topic : {camera.raw_topic, camera.compressed_topic}) {
    if (const Watched* images = find(topic); images != nullptr && !camera.images) camera.images = finished(*images);
  }
  if (const Watched* info = find(camera.info_topic)) camera.info_stream = finished(*info);
  if (const auto info = infos_.find(camera.info_topic); info != infos_.end()) camera.info = info->second;
  return camera;
}

Snapshot DomainWatch::snapshot() const {
  Snapshot seen;
  const dds::DiscoverySettings discovery = dds::discovery_from_environment();
  const Settings& settings = domain_.settings();
  seen.domain = settings.domain.value_or(discovery.domain);
  seen.range = range_text(discovery);
  seen.seconds = seconds_;
  seen.participants = domain_.participants();
  seen.nodes = domain_.nodes();
  seen.endpoints = domain_.seen();
  seen.runs = runs_of(seen.endpoints);
  seen.color = camera("colour");
  seen.depth = camera("depth");
  for (const std::string& topic : {name_of(domain_, topics::kLabels), name_of(domain_, topics::kWheelOdometry),
                                   name_of(domain_, topics::kImu), name_of(domain_, topics::kClock)}) {
    if (const Watched* watched = find(topic)) seen.others[topic] = finished(*watched);
  }
  seen.static_transforms_topic = name_of(domain_, topics::kStaticTransforms);
  if (const Watched* transforms = find(seen.static_transforms_topic)) {
    seen.static_transforms_stream = finished(*transforms);
  }
  seen.static_transforms = static_transforms_;
  seen.base_frame = dds::in_namespace(domain_.names().full("base_link", true), settings.name_space);
  seen.labels_topic = name_of(domain_, topics::kLabels);
  seen.label_info_topic = name_of(domain_, topics::kLabelInfo);
  seen.clock_ns = clock_ns_;
  seen.system_ns = system_ns_;
  seen.known_topics = known_topics(domain_);
  seen.known_hashes = known_hashes();
  seen.wanted_socket_buffer_bytes = settings.socket_buffer_bytes;
  seen.socket_buffer_bytes = dds::effective_socket_buffer_bytes(settings.socket_buffer_bytes);
  seen.has_network_interface = dds::has_network_interface();
  return seen;
}

}  // namespace lapis::command_line
