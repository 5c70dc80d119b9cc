#include "command_line/core/checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>

namespace lapis::command_line {
namespace {

constexpr int kSmallSocketBuffer = 1 << 20;  // an image of VGA size; smaller ones lose parts of it (decision 0004)
constexpr double kLeastRate_hz = 5.0;        // docs/topics.md
constexpr double kMostLost = 0.05;           // of a sensor's messages; a camera of 30 Hz stays above 28
constexpr double kFarClock_s = 10.0;         // for as long tf2 keeps transforms by default
// As slam joins depth with colour: by the time between colour images, up to this.
constexpr double kJoinedShare = 0.6, kMostJoined_s = 0.12;
constexpr double kSameCamera = 0.01;  // relative difference of focal lengths; calibrations repeat to some 0.1 %

using Findings = std::vector<Finding>;

std::string text_of(double value, const char* format = "%.1f") {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

std::string node_of(const SeenEndpoint& endpoint) {
  return endpoint.node.empty() ? "a bare DDS program" : endpoint.node;
}

std::string nodes_of(const std::vector<SeenEndpoint>& endpoints) {
  std::string text;
  for (const SeenEndpoint& endpoint : endpoints) text += (text.empty() ? "" : " and ") + node_of(endpoint);
  return text;
}

// ---- this machine and the domain

void check_machine(const Snapshot& seen, Findings& findings) {
  if (seen.socket_buffer_bytes < std::min(kSmallSocketBuffer, seen.wanted_socket_buffer_bytes) ||
      seen.wanted_socket_buffer_bytes < kSmallSocketBuffer) {
    findings.push_back({"small_buffers", "",
                        "UDP sockets get " + std::to_string(seen.socket_buffer_bytes) +
                            " bytes, too few for an image: images are late or lost",
                        "launch_scripts/setup.sh --sysctl, on each machine (net.core.rmem_max and wmem_max 8388608)"});
  }
  if (!seen.has_network_interface && seen.range == "SUBNET") {
    findings.push_back({"no_network", "", "no network interface is up, so other machines cannot be found",
                        "connect this machine, or set ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST for this host alone"});
  }
}

void check_presence(const Snapshot& seen, Findings& findings) {
  if (!seen.endpoints.empty()) return;
  const std::string who = seen.range == "OFF" ? ", and ROS_AUTOMATIC_DISCOVERY_RANGE=OFF forbids to look" : "";
  findings.push_back({"nothing_there", "", "nobody is in domain " + std::to_string(seen.domain) + who,
                      "start the camera, with the same ROS_DOMAIN_ID and ROS_AUTOMATIC_DISCOVERY_RANGE (here " +
                          seen.range +
                          ") as here; across machines SUBNET, ROS_STATIC_PEERS, no firewall on UDP 7400 up"});
}

void check_runs(const Snapshot& seen, Findings& findings) {
  if (seen.runs.size() < 2) return;
  findings.push_back(
      {"two_runs", "",
       "runs " + seen.runs[0] + " and " + seen.runs[1] + " share the domain and refuse each other's data",
       "end one of them, or give it another ROS_DOMAIN_ID"});
}

// ---- who meets whom

void check_match(const SeenTopic& topic, const SeenEndpoint& writer, const SeenEndpoint& reader, Findings& findings) {
  const std::string pair = node_of(writer) + " to " + node_of(reader);
  if (reader.is_reliable && !writer.is_reliable) {
    findings.push_back({"reliability", topic.name,
                        "nothing goes from " + pair + ": best effort is offered, reliable wanted",
                        "publish it reliable, or read it best effort (Lapis: dds.sensor_qos=best_effort)"});
  } else if (reader.is_latched && !writer.is_latched) {
    findings.push_back({"durability", topic.name,
                        "nothing goes from " + pair + ": volatile is offered, transient local wanted",
                        "publish it transient local, or read it volatile"});
  } else if (reader.is_keyed != writer.is_keyed) {
    findings.push_back({"keys", topic.name, "nothing goes from " + pair + ": one has keys, the other none",
                        "use one declaration of the type; ROS 2 has no keys"});
  }
}

/// One finding for each fault of a topic, not for each pair of its endpoints.
void check_pairs(const SeenTopic& topic, Findings& findings) {
  std::set<std::string> named;
  Findings of_topic;
  for (const SeenEndpoint& writer : topic.writers) {
    for (const SeenEndpoint& reader : topic.readers) {
      if (writer.type == reader.type) check_match(topic, writer, reader, of_topic);
    }
  }
  for (Finding& finding : of_topic) {
    if (named.insert(finding.fault).second) findings.push_back(std::move(finding));
  }
}

void check_types(const SeenTopic& topic, const std::string& wanted, Findings& findings) {
  if (topic.types.size() > 1) {
    findings.push_back({"two_types", topic.name, "it is used as " + topic.types[0] + " and as " + topic.types[1],
                        "rename one of the two (--remap in Lapis)"});
  } else if (!wanted.empty() && topic.types[0] != wanted) {
    findings.push_back({"wrong_type", topic.name, "its type is " + topic.types[0] + ", Lapis reads " + wanted,
                        "publish " + wanted + ", or rename the topic"});
  }
}

void check_hashes(const Snapshot& seen, const SeenTopic& topic, Findings& findings) {
  for (const auto* endpoints : {&topic.writers, &topic.readers}) {
    for (const SeenEndpoint& endpoint : *endpoints) {
      const auto known = seen.known_hashes.find(endpoint.type);
      if (endpoint.type_hash.empty() || known == seen.known_hashes.end() || endpoint.type_hash == known->second)
        continue;
      findings.push_back({"type_hash", topic.name,
                          node_of(endpoint) + " has another declaration of " + endpoint.type +
                              ": fields are read as what they are not",
                          "use ROS 2 Jazzy's declaration there, and the package idl/ros2/lapis_msgs of this version"});
      return;
    }
  }
}

void check_writers(const SeenTopic& topic, const KnownTopic& known, Findings& findings) {
  if (topic.writers.size() > 1 && !known.has_many_writers) {
    findings.push_back({"two_publishers", topic.name, "it is published by " + nodes_of(topic.writers),
                        "end one of the two, or rename its topic; a run of Lapis hears only one"});
  }
  const auto is_volatile = [](const SeenEndpoint& writer) { return !writer.is_latched; };
  if (known.is_latched && std::ranges::any_of(topic.writers, is_volatile)) {
    findings.push_back({"not_latched", topic.name, "it is published volatile: who starts later does not get it",
                        "publish it transient local (static_transform_publisher does so)"});
  }
}

void check_endpoints(const Snapshot& seen, Findings& findings) {
  for (const SeenTopic& topic : topics_of(seen.endpoints)) {
    const auto known = std::ranges::find(seen.known_topics, topic.name, &KnownTopic::name);
    const bool is_known = known != seen.known_topics.end();
    check_types(topic, is_known ? known->type : "", findings);
    check_hashes(seen, topic, findings);
    if (is_known) check_writers(topic, *known, findings);
    check_pairs(topic, findings);
  }
}

// ---- the camera

void check_silence(const SeenStream& stream, double seconds, Findings& findings) {
  if (stream.messages > 0) return;
  findings.push_back({"silent", stream.topic, "it has a publisher, but nothing came in " + text_of(seconds) + " s",
                      "look at the log of its publisher; over a network, at the firewall and at small_buffers"});
}

void check_images(const SeenCamera& camera, double seconds, Findings& findings) {
  if (!camera.images) {
    findings.push_back({camera.what == "depth" ? "no_depth" : "no_color", camera.raw_topic,
                        "nobody publishes " + camera.what + " images",
                        "start the camera's " + camera.what + " stream, or name its topic: --remap " +
                            camera.raw_topic + ":=/its/name (lapis topics lists them)"});
    return;
  }
  const SeenStream& images = *camera.images;
  check_silence(images, seconds, findings);
  if (images.topic == camera.compressed_topic) {
    findings.push_back({"compressed_only", images.topic, "images of " + camera.what + " come compressed alone",
                        "start Lapis with --set " + camera.compressed_setting});
  }
  if (!images.encoding.empty() && images.topic == camera.raw_topic &&
      std::ranges::find(camera.encodings, images.encoding) == camera.encodings.end()) {
    std::string known;
    for (const std::string& encoding : camera.encodings) known += (known.empty() ? "" : ", ") + encoding;
    findings.push_back(
        {"encoding", images.topic, "its encoding is '" + images.encoding + "'", "set the driver to one of " + known});
  }
}

/// By the stamps, because a simulator may be slower or faster than life. 0: it cannot be told.
double stamp_rate_hz(const SeenStream& stream) {
  if (stream.stamps_ns.size() < 2) return 0.0;
  const auto [first, last] = std::ranges::minmax(stream.stamps_ns);
  if (first == last) return 0.0;
  return static_cast<double>(stream.stamps_ns.size() - 1) / (1e-9 * static_cast<double>(last - first));
}

void check_flow(const SeenStream& stream, Findings& findings) {
  const auto sent = static_cast<double>(stream.messages + stream.lost);
  if (static_cast<double>(stream.lost) > kMostLost * sent) {
    findings.push_back({"losses", stream.topic,
                        std::to_string(stream.lost) + " of " + std::to_string(stream.messages + stream.lost) +
                            " messages were lost on the way: they come below the rate at which they are published",
                        "larger socket buffers (setup.sh --sysctl) on both machines, publish reliable, smaller or "
                        "compressed images, cable instead of Wi-Fi"});
  }
  if (const double rate_hz = stamp_rate_hz(stream); rate_hz > 0.0 && rate_hz < kLeastRate_hz) {
    findings.push_back({"slow", stream.topic,
                        "its images are taken at " + text_of(rate_hz) + " Hz, too seldom to track motion",
                        "set the camera to " + text_of(kLeastRate_hz, "%.0f") + " Hz or more"});
  }
  const auto& stamps = stream.stamps_ns;
  if (std::ranges::adjacent_find(stamps, std::ranges::greater_equal{}) != stamps.end()) {
    findings.push_back({"stamps_repeat", stream.topic, "time stamps repeat or go back",
                        "let the driver stamp each image with its time of exposure; look for a second publisher"});
  }
}

void check_info(const SeenCamera& camera, double seconds, bool is_needed, Findings& findings) {
  if (!camera.images) return;
  if (!camera.info_stream) {
    if (!is_needed) return;
    findings.push_back({"no_camera_info", camera.info_topic, "nobody publishes the camera info of " + camera.what,
                        "let the driver publish it, or rename it: --remap " + camera.info_topic + ":=/its/name"});
    return;
  }
  check_silence(*camera.info_stream, seconds, findings);
  if (!camera.info) return;
  const SeenCameraInfo& info = *camera.info;
  const SeenStream& images = *camera.images;
  if (images.width > 0 && (images.width != info.width || images.height != info.height)) {
    findings.push_back({"info_size", camera.info_topic,
                        "it is of images of " + size_text(info.width, info.height) + ", those of " + images.topic +
                            " are " + size_text(images.width, images.height),
                        "use the calibration of this resolution"});
  }
  if (!(info.fx > 0.0 && info.fy > 0.0)) {
    findings.push_back({"info_empty", camera.info_topic, "it has no focal length: the camera is not calibrated",
                        "calibrate the camera, and give the driver the file"});
  }
  const bool is_model_known = info.distortion_model.empty() || info.distortion_model == "plumb_bob" ||
                              info.distortion_model == "rational_polynomial";
  if (!is_model_known) {
    findings.push_back({"info_model", camera.info_topic,
                        "Lapis does not read distortion model " + info.distortion_model,
                        "publish rectified images, or calibrate with plumb_bob or rational_polynomial"});
  }
  if (!images.frame.empty() && images.frame != info.frame) {
    findings.push_back({"info_frame", camera.info_topic,
                        "its frame is '" + info.frame + "', that of the images '" + images.frame + "'",
                        "give both the same frame_id, that of the optical frame"});
  }
}

/// Depth in the frame of colour is said to be registered to it, so both have one camera.
void check_registration(const Snapshot& seen, Findings& findings) {
  if (!seen.color.images || !seen.depth.images || !seen.color.info) return;
  const SeenStream &color = *seen.color.images, &depth = *seen.depth.images;
  if (color.frame.empty() || color.frame != depth.frame || color.width == 0 || depth.width == 0) return;
  std::string problem;
  if (seen.depth.info) {
    const SeenCameraInfo &a = *seen.color.info, &b = *seen.depth.info;
    const double scale = a.width > 0 ? static_cast<double>(b.width) / a.width : 1.0;
    const auto differs = [scale](double x, double y) { return std::abs(scale * x - y) > kSameCamera * scale * x; };
    if (differs(a.fx, b.fx) || differs(a.fy, b.fy)) {
      problem = "its focal length is " + text_of(b.fx) + " px, that of colour " + text_of(a.fx) + " px";
    }
  } else if (color.width != depth.width || color.height != depth.height) {
    problem = "depth is " + size_text(depth.width, depth.height) + ", colour " + size_text(color.width, color.height);
  }
  if (problem.empty()) return;
  findings.push_back({"info_differs", seen.depth.info_topic,
                      problem + ", although depth has the frame of colour ('" + depth.frame + "')",
                      "align depth to colour in the driver, or let depth have its own frame_id and /tf_static"});
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Median time from each stamp to the nearest of the others, which are sorted.
double median_distance_s(const std::vector<std::int64_t>& stamps, const std::vector<std::int64_t>& others) {
  std::vector<double> distances_s;
  for (const std::int64_t stamp : stamps) {
    const auto next = std::ranges::lower_bound(others, stamp);
    const std::int64_t after = next == others.end() ? others.back() : *next;
    const std::int64_t before = next == others.begin() ? others.front() : *std::prev(next);
    distances_s.push_back(1e-9 * static_cast<double>(std::min(std::abs(after - stamp), std::abs(stamp - before))));
  }
  return median(std::move(distances_s));
}

/// Depth is apart from colour when no colour image is near, or when images that come together have stamps that are not.
void check_stamps_together(const Snapshot& seen, Findings& findings) {
  if (!seen.color.images || !seen.depth.images) return;
  std::vector<std::int64_t> color = seen.color.images->stamps_ns;
  const std::vector<std::int64_t>& depth = seen.depth.images->stamps_ns;
  std::ranges::sort(color);
  if (color.size() < 3 || depth.size() < 3) return;
  std::vector<double> gaps_s;
  for (std::size_t i = 1; i < color.size(); ++i) gaps_s.push_back(1e-9 * static_cast<double>(color[i] - color[i - 1]));
  const double distance_s = median_distance_s(depth, color);
  const double late_s = std::abs(seen.depth.images->delay_s - seen.color.images->delay_s);
  if (distance_s <= std::min(kJoinedShare * median(gaps_s), kMostJoined_s) && late_s <= kMostJoined_s) return;
  findings.push_back({"stamps_apart", seen.depth.images->topic,
                      "the stamps of depth are " + text_of(1e3 * std::max(distance_s, late_s), "%.0f") +
                          " ms apart from those of the colour images that come with it",
                      "synchronise both in the driver, and stamp both by one clock"});
}

void check_clock(const Snapshot& seen, Findings& findings) {
  for (const SeenCamera* camera : {&seen.color, &seen.depth}) {
    if (!camera->images || camera->images->stamps_ns.empty()) continue;
    const std::int64_t now_ns = seen.clock_ns.value_or(seen.system_ns);
    const double ahead_s = 1e-9 * static_cast<double>(camera->images->stamps_ns.back() - now_ns);
    if (std::abs(ahead_s) <= kFarClock_s) continue;
    findings.push_back(
        {"far_clock", camera->images->topic,
         "its stamps are " + text_of(std::abs(ahead_s)) + " s " + (ahead_s > 0.0 ? "ahead of " : "behind ") +
             (seen.clock_ns ? "/clock" : "this machine's clock"),
         seen.clock_ns ? "let camera and /clock have one source"
                       : "set the clocks of both machines (chrony, NTP); a replay has to publish /clock"});
    return;
  }
}

// ---- frames and labels

/// The frames that are connected with one, by static transforms.
std::set<std::string> connected_with(const std::string& frame, const std::vector<SeenTransform>& transforms) {
  std::set<std::string> found{frame};
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (const SeenTransform& transform : transforms) {
      const bool touches = found.contains(transform.parent) || found.contains(transform.child);
      if (touches) has_grown |= found.insert(transform.parent).second | found.insert(transform.child).second;
    }
  }
  return found;
}

void check_frames(const Snapshot& seen, Findings& findings) {
  if (!seen.static_transforms_stream) {
    findings.push_back({"no_tf_static", seen.static_transforms_topic, "nobody says where the camera is on the robot",
                        "let the robot's description or static_transform_publisher publish " + seen.base_frame +
                            " -> the camera's optical frame"});
    return;
  }
  check_silence(*seen.static_transforms_stream, seen.seconds, findings);
  if (seen.static_transforms.empty()) return;
  const std::set<std::string> mounted = connected_with(seen.base_frame, seen.static_transforms);
  std::set<std::string> named;
  for (const SeenCamera* camera : {&seen.color, &seen.depth}) {
    if (!camera->images || camera->images->messages == 0) continue;
    const std::string& frame = camera->images->frame;
    if (mounted.contains(frame) || !named.insert(frame).second) continue;
    findings.push_back({"unknown_frame", camera->images->topic,
                        "no static transform connects its frame '" + frame + "' with '" + seen.base_frame + "'",
                        "publish that transform on " + seen.static_transforms_topic +
                            ", or rename the robot's frame: --remap base_link:=its_name"});
  }
}

void check_labels(const Snapshot& seen, Findings& findings) {
  const auto is_published = [&](const std::string& topic) {
    return std::ranges::any_of(seen.endpoints, [&](const auto& e) { return e.is_writer && e.topic == topic; });
  };
  if (!is_published(seen.labels_topic) || is_published(seen.label_info_topic)) return;
  findings.push_back({"no_label_info", seen.label_info_topic, "labels come without the names of their classes",
                      "let the segmentation publish it (type LabelInfo of vision_msgs), transient local"});
}

}  // namespace

std::vector<Finding> findings_in(const Snapshot& seen) {
  Findings findings;
  check_presence(seen, findings);
  if (!findings.empty()) {
    check_machine(seen, findings);
    return findings;
  }
  check_images(seen.color, seen.seconds, findings);
  check_images(seen.depth, seen.seconds, findings);
  check_info(seen.color, seen.seconds, true, findings);
  check_info(seen.depth, seen.seconds, false, findings);
  check_frames(seen, findings);
  check_runs(seen, findings);
  check_endpoints(seen, findings);
  check_registration(seen, findings);
  check_stamps_together(seen, findings);
  check_clock(seen, findings);
  for (const SeenCamera* camera : {&seen.color, &seen.depth}) {
    if (camera->images) check_flow(*camera->images, findings);
  }
  for (const auto& [name, stream] : seen.others) check_silence(stream, seen.seconds, findings);
  check_labels(seen, findings);
  check_machine(seen, findings);
  return findings;
}

}  // namespace lapis::command_line
