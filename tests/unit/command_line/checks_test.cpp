#include "command_line/core/checks.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace lapis::command_line {
namespace {

constexpr std::int64_t kNow_ns = 1'700'000'000'000'000'000, kFrame_ns = 33'333'333;
constexpr const char* kImage = "sensor_msgs/msg/Image";
constexpr const char* kInfo = "sensor_msgs/msg/CameraInfo";

SeenStream stream(const std::string& topic) {
  SeenStream seen{.topic = topic, .messages = 60, .rate_hz = 30.0, .frame = "optical"};
  for (int i = 0; i < 60; ++i) seen.stamps_ns.push_back(kNow_ns + kFrame_ns * (i - 60));
  return seen;
}

SeenStream images(const std::string& topic, const std::string& encoding) {
  SeenStream seen = stream(topic);
  seen.width = 640;
  seen.height = 480;
  seen.encoding = encoding;
  return seen;
}

SeenEndpoint writer(const std::string& topic, const std::string& type) {
  return {.is_writer = true,
          .topic = topic,
          .type = type,
          .is_reliable = true,
          .type_hash = "RIHS01_" + type,
          .node = "/camera"};
}

SeenCamera camera(const std::string& what, const std::string& encoding) {
  const std::string prefix = what == "depth" ? "/depth" : "/color";
  return {.what = what,
          .raw_topic = prefix,
          .compressed_topic = prefix + "/compressed",
          .info_topic = prefix + "_info",
          .compressed_setting = "compressed",
          .encodings = {encoding},
          .images = images(prefix, encoding),
          .info_stream = stream(prefix + "_info"),
          .info = SeenCameraInfo{"optical", 640, 480, 500.0, 500.0, 320.0, 240.0, "plumb_bob"}};
}

/// A camera of 30 Hz, with all that it needs.
Snapshot healthy() {
  Snapshot seen;
  seen.range = "SUBNET";
  seen.seconds = 2.0;
  seen.color = camera("colour", "rgb8");
  seen.depth = camera("depth", "16UC1");
  for (const char* topic : {"/color", "/depth"}) {
    seen.endpoints.push_back(writer(topic, kImage));
    seen.endpoints.push_back(writer(topic + std::string("_info"), kInfo));
    seen.known_topics.push_back({topic, kImage});
    seen.known_topics.push_back({topic + std::string("_info"), kInfo});
  }
  seen.endpoints.push_back(writer("/tf_static", "tf2_msgs/msg/TFMessage"));
  seen.endpoints.back().is_latched = true;
  seen.known_topics.push_back({"/tf_static", "tf2_msgs/msg/TFMessage", true, true});
  for (const SeenEndpoint& endpoint : seen.endpoints) seen.known_hashes[endpoint.type] = endpoint.type_hash;
  seen.static_transforms_topic = "/tf_static";
  seen.static_transforms_stream = SeenStream{.topic = "/tf_static", .messages = 1};
  seen.static_transforms = {{"camera", "optical"}, {"base_link", "camera"}};
  seen.base_frame = "base_link";
  seen.labels_topic = "/labels";
  seen.label_info_topic = "/label_info";
  seen.system_ns = kNow_ns;
  seen.socket_buffer_bytes = seen.wanted_socket_buffer_bytes = 4 << 20;
  return seen;
}

struct Fault {
  const char* name;
  std::function<void(Snapshot&)> make;
};

class Checks : public ::testing::TestWithParam<Fault> {};

/// Each fault is found, with a remedy, and nothing else.
TEST_P(Checks, FindTheFault) {
  Snapshot seen = healthy();
  GetParam().make(seen);
  std::set<std::string> found;
  for (const Finding& finding : findings_in(seen)) {
    found.insert(finding.fault);
    EXPECT_FALSE(finding.problem.empty());
    EXPECT_FALSE(finding.remedy.empty());
  }
  EXPECT_EQ(found, std::set<std::string>{GetParam().name});
}

SeenEndpoint reader(const std::string& topic, const std::string& type) {
  SeenEndpoint seen = writer(topic, type);
  seen.is_writer = false;
  seen.node = "/slam";
  return seen;
}

const Fault kFaults[] = {
    {"nothing_there", [](Snapshot& s) { s.endpoints.clear(); }},
    {"no_color", [](Snapshot& s) { s.color.images.reset(); }},
    {"no_depth", [](Snapshot& s) { s.depth.images.reset(); }},
    {"no_camera_info", [](Snapshot& s) { s.color.info_stream.reset(), s.color.info.reset(); }},
    {"no_tf_static", [](Snapshot& s) { s.static_transforms_stream.reset(); }},
    {"silent", [](Snapshot& s) { s.others["/odom"] = SeenStream{.topic = "/odom"}; }},
    {"compressed_only", [](Snapshot& s) { s.color.images->topic = s.color.compressed_topic; }},
    {"encoding", [](Snapshot& s) { s.depth.images->encoding = "64FC1"; }},
    {"losses", [](Snapshot& s) { s.color.images->lost = 6; }},
    {"slow",
     [](Snapshot& s) {
       for (auto* images : {&*s.color.images, &*s.depth.images}) {
         for (auto& stamp : images->stamps_ns) stamp = kNow_ns + 8 * (stamp - kNow_ns);
       }
     }},
    {"stamps_repeat", [](Snapshot& s) { s.color.images->stamps_ns[9] = s.color.images->stamps_ns[8]; }},
    {"stamps_apart", [](Snapshot& s) { s.depth.images->delay_s = 0.2; }},
    {"stamps_apart",
     [](Snapshot& s) {
       for (auto& stamp : s.depth.images->stamps_ns) stamp += 5'000'000'000;
     }},
    {"far_clock", [](Snapshot& s) { s.system_ns += 11'000'000'000; }},
    {"far_clock", [](Snapshot& s) { s.clock_ns = kNow_ns - 11'000'000'000; }},
    {"info_size",
     [](Snapshot& s) {
       s.color.info->width = 320, s.color.info->height = 240, s.color.info->fx = s.color.info->fy = 250.0;
     }},
    {"info_empty", [](Snapshot& s) { s.color.info->fx = s.depth.info->fx = 0.0; }},
    {"info_model", [](Snapshot& s) { s.color.info->distortion_model = "equidistant"; }},
    {"info_frame", [](Snapshot& s) { s.color.info->frame = "elsewhere"; }},
    {"info_differs", [](Snapshot& s) { s.depth.info->fx = s.depth.info->fy = 380.0; }},
    {"info_differs",
     [](Snapshot& s) { s.depth.info.reset(), s.depth.info_stream.reset(), s.depth.images->width = 320; }},
    {"unknown_frame", [](Snapshot& s) { s.static_transforms.pop_back(); }},
    {"two_publishers", [](Snapshot& s) { s.endpoints.push_back(writer("/color", kImage)); }},
    {"not_latched", [](Snapshot& s) { s.endpoints.back().is_latched = false; }},
    {"two_types", [](Snapshot& s) { s.endpoints.push_back(reader("/color", kInfo)); }},
    {"wrong_type", [](Snapshot& s) { s.endpoints[0].type = "std_msgs/msg/String"; }},
    {"type_hash", [](Snapshot& s) { s.endpoints[0].type_hash = "RIHS01_other"; }},
    {"reliability",
     [](Snapshot& s) {
       s.endpoints[0].is_reliable = false;
       s.endpoints.push_back(reader("/color", kImage));
     }},
    {"durability",
     [](Snapshot& s) {
       s.endpoints.push_back(reader("/color", kImage));
       s.endpoints.back().is_latched = true;
     }},
    {"keys",
     [](Snapshot& s) {
       s.endpoints.push_back(reader("/color", kImage));
       s.endpoints.back().is_keyed = true;
     }},
    {"two_runs",
     [](Snapshot& s) {
       s.runs = {"one", "two"};
     }},
    {"no_label_info", [](Snapshot& s) { s.endpoints.push_back(writer("/labels", kImage)); }},
    {"small_buffers", [](Snapshot& s) { s.socket_buffer_bytes = 212'992; }},
    {"no_network", [](Snapshot& s) { s.has_network_interface = false; }},
};

INSTANTIATE_TEST_SUITE_P(Faults, Checks, ::testing::ValuesIn(kFaults), [](const auto& fault) {
  return std::string(fault.param.name) + "_" + std::to_string(fault.index);
});

TEST(Checks, FindNothingWhereAllIsWell) {
  EXPECT_TRUE(findings_in(healthy()).empty());
  Snapshot seen = healthy();
  seen.color.images->lost = 3;                         // of 63
  seen.endpoints[0].type_hash.clear();                 // ROS 2 Humble has none
  seen.endpoints.push_back(reader("/color", kImage));  // some reader
  seen.depth.images->frame = "depth_optical";          // a camera of its own
  seen.depth.info->frame = "depth_optical";
  seen.depth.info->fx = 380.0;
  seen.static_transforms.push_back({"optical", "depth_optical"});
  seen.clock_ns = kNow_ns + 100;  // of a simulator, whatever the system's clock says
  seen.system_ns = 0;
  EXPECT_TRUE(findings_in(seen).empty());
}

TEST(Checks, CompareCameraInfosOfTwoSizes) {
  Snapshot seen = healthy();
  seen.depth.images->width = seen.depth.info->width = 320;
  seen.depth.images->height = seen.depth.info->height = 240;
  seen.depth.info->fx = seen.depth.info->fy = 250.0;
  EXPECT_TRUE(findings_in(seen).empty());
}

TEST(Checks, SayOnceWhatManyReadersSuffer) {
  Snapshot seen = healthy();
  seen.endpoints[0].is_reliable = false;
  for (int i = 0; i < 5; ++i) seen.endpoints.push_back(reader("/color", kImage));
  EXPECT_EQ(findings_in(seen).size(), 1U);
}

}  // namespace
}  // namespace lapis::command_line
