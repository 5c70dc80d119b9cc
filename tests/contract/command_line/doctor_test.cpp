// lapis doctor on set-ups that the test makes over real DDS.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "common/dds/participant.hpp"
#include "common/dds/raw.hpp"
#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/robot.hpp"
#include "common/topics/transforms.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/in_run.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

using sensor_msgs::msg::CameraInfo;
using sensor_msgs::msg::Image;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr const char* kOpticalFrame = "camera_color_optical_frame";
constexpr auto kPeriod = std::chrono::milliseconds(66);
constexpr int kWidth = 64, kHeight = 48;

/// What a broken camera does otherwise.
struct Habits {
  bool has_color = true, has_depth = true, has_info = true, has_depth_info = true, has_mount = true;
  bool sends_depth = true;
  std::chrono::milliseconds depth_late{0};
  std::chrono::seconds clock_ahead{0};
  std::chrono::milliseconds period = kPeriod;
  bool repeats_stamps = false;
  int row_bytes = 0;  ///< more than pixels need makes images large
  int burst = 1;      ///< images that are published at once
  dds::Qos image_qos = topics::kColor.qos, mount_qos = topics::kStaticTransforms.qos;
  std::string depth_encoding = "16UC1", mounted_frame = kOpticalFrame;
  std::function<void(CameraInfo&)> spoil_info = {}, spoil_depth_info = {};
};

/// A camera of 15 Hz, as long as the probe waits.
class Camera {
 public:
  Camera(TopicProbe& probe, Habits habits) : habits_(std::move(habits)) {
    if (habits_.has_color) color_ = &probe.advertise(with_qos(topics::kColor, habits_.image_qos));
    if (habits_.has_depth) depth_ = &probe.advertise(with_qos(topics::kDepth, habits_.image_qos));
    if (habits_.has_info) color_info_ = &probe.advertise(topics::kColorInfo);
    if (habits_.has_info && habits_.has_depth_info) depth_info_ = &probe.advertise(topics::kDepthInfo);
    if (habits_.has_mount) mount_ = &probe.advertise(with_qos(topics::kStaticTransforms, habits_.mount_qos));
    if (mount_ != nullptr) mount_->publish(mount());
    probe.participant().announce_graph();
    probe.executor().every(habits_.period, [this] { send(); });
  }

 private:
  template <class Message>
  static dds::Topic<Message> with_qos(dds::Topic<Message> topic, const dds::Qos& qos) {
    topic.qos = qos;
    return topic;
  }

  tf2_msgs::msg::TFMessage mount() const {
    tf2_msgs::msg::TFMessage message;
    message.transforms().resize(1);
    message.transforms()[0].header().frame_id("base_link");
    message.transforms()[0].child_frame_id(habits_.mounted_frame);
    message.transforms()[0].transform().rotation().w(1.0);
    return message;
  }

  std_msgs::msg::Header header(time::Time stamp) const {
    std_msgs::msg::Header header;
    header.stamp(messages::to_message(stamp));
    header.frame_id(kOpticalFrame);
    return header;
  }

  Image image(time::Time stamp, const std::string& encoding, int bytes_per_pixel) const {
    Image image;
    image.header(header(stamp));
    image.width(kWidth);
    image.height(kHeight);
    image.encoding(encoding);
    const int row_bytes = std::max(kWidth * bytes_per_pixel, habits_.row_bytes);
    image.step(static_cast<std::uint32_t>(row_bytes));
    image.data().resize(static_cast<std::size_t>(row_bytes * kHeight));
    return image;
  }

  CameraInfo info(time::Time stamp, const std::function<void(CameraInfo&)>& spoil) const {
    CameraInfo info;
    info.header(header(stamp));
    info.width(kWidth);
    info.height(kHeight);
    info.distortion_model("plumb_bob");
    info.k() = {60.0, 0.0, 32.0, 0.0, 60.0, 24.0, 0.0, 0.0, 1.0};
    if (spoil) spoil(info);
    return info;
  }

  void send() {
    const auto now = std::chrono::system_clock::now().time_since_epoch() + habits_.clock_ahead;
    if (!habits_.repeats_stamps || !first_) first_ = time::Time{std::chrono::nanoseconds(now).count()};
    const time::Time stamp = *first_;
    const time::Time depth_stamp = stamp + time::Duration{std::chrono::nanoseconds(habits_.depth_late).count()};
    if (color_info_ != nullptr) color_info_->publish(info(stamp, habits_.spoil_info));
    if (depth_info_ != nullptr) depth_info_->publish(info(depth_stamp, habits_.spoil_depth_info));
    for (int i = 0; i < habits_.burst; ++i) {
      if (color_ != nullptr) color_->publish(image(stamp, "rgb8", 3));
      if (depth_ != nullptr && habits_.sends_depth) depth_->publish(image(depth_stamp, habits_.depth_encoding, 2));
    }
  }

  Habits habits_;
  std::optional<time::Time> first_;
  dds::Publisher<Image>* color_ = nullptr;
  dds::Publisher<Image>* depth_ = nullptr;
  dds::Publisher<CameraInfo>* color_info_ = nullptr;
  dds::Publisher<CameraInfo>* depth_info_ = nullptr;
  dds::Publisher<tf2_msgs::msg::TFMessage>* mount_ = nullptr;
};

class Doctor : public ::testing::Test {
 protected:
  struct Answer {
    std::optional<int> status;
    std::set<std::string> faults;
    std::string log;
    nlohmann::json value;
  };

  Answer examine(std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.begin(), {"doctor", "--json", "--seconds", "1.5"});
    ChildProcess doctor("lapis", arguments);
    probe_.wait_until([&] { return !doctor.is_running(); }, Seconds(20));
    Answer answer{doctor.wait(), {}, doctor.log(), nlohmann::json::parse(doctor.output(), nullptr, false)};
    if (!answer.value.is_object()) return answer;
    for (const auto& finding : answer.value["findings"]) {
      EXPECT_FALSE(finding["problem"].get<std::string>().empty());
      EXPECT_FALSE(finding["remedy"].get<std::string>().empty());
      answer.faults.insert(finding["fault"]);
    }
    if (!has_large_buffers_) answer.faults.erase("small_buffers");
    return answer;
  }

  /// The one fault, and nothing else, is found.
  void expect_found(const std::string& fault, Habits habits = {}, const std::vector<std::string>& arguments = {}) {
    const Camera camera(probe_, std::move(habits));
    const Answer answer = examine(arguments);
    EXPECT_EQ(answer.faults, std::set<std::string>{fault}) << answer.log;
    EXPECT_EQ(answer.status, 1) << answer.log;
  }

  TopicProbe probe_{"camera"};
  bool has_large_buffers_ = dds::effective_socket_buffer_bytes(4 << 20) >= (1 << 20);
};

TEST_F(Doctor, FindsNothingInACameraThatWorks) {
  const Camera camera(probe_, {});
  auto& odometry = probe_.advertise(topics::kWheelOdometry);
  probe_.executor().every(std::chrono::milliseconds(50), [&] { odometry.publish({}); });
  const Answer answer = examine();
  EXPECT_THAT(answer.faults, ::testing::IsEmpty()) << answer.log;
  ASSERT_EQ(answer.value["streams"].size(), 2U) << answer.log;
  EXPECT_NEAR(answer.value["streams"][0]["rate_hz"], 15.0, 5.0);
  EXPECT_THAT(answer.value["nodes"], Contains("/camera"));
  if (has_large_buffers_) {
    EXPECT_EQ(answer.status, 0) << answer.log;
  }
}

TEST_F(Doctor, SaysItInWordsToo) {
  const Camera camera(probe_, {.has_depth = false});
  ChildProcess doctor("lapis", {"doctor", "--seconds", "0.5"});
  probe_.wait_until([&] { return !doctor.is_running(); }, Seconds(20));
  EXPECT_EQ(doctor.wait(), 1);
  EXPECT_THAT(doctor.output(), HasSubstr("no_depth  /camera/depth/image_raw: nobody publishes depth images"));
  EXPECT_THAT(doctor.output(), HasSubstr("--remap /camera/depth/image_raw:=/its/name"));
}

TEST(DoctorAlone, FindsThatNothingIsThere) {
  ChildProcess doctor("lapis", {"doctor", "--json", "--wait", "0.5", "--seconds", "0.1"});
  EXPECT_EQ(doctor.wait(), 1) << doctor.log();
  EXPECT_THAT(doctor.output(), HasSubstr("nothing_there"));
}

TEST_F(Doctor, FindsThatDepthIsMissing) { expect_found("no_depth", {.has_depth = false}); }
TEST_F(Doctor, FindsThatColourIsMissing) { expect_found("no_color", {.has_color = false}); }
TEST_F(Doctor, FindsThatCameraInfoIsMissing) { expect_found("no_camera_info", {.has_info = false}); }
TEST_F(Doctor, FindsThatTheMountIsMissing) { expect_found("no_tf_static", {.has_mount = false}); }
TEST_F(Doctor, FindsDepthThatIsSilent) { expect_found("silent", {.sends_depth = false}); }
TEST_F(Doctor, FindsAClockThatIsFarAway) { expect_found("far_clock", {.clock_ahead = std::chrono::seconds(3600)}); }
TEST_F(Doctor, FindsStampsThatRepeat) { expect_found("stamps_repeat", {.repeats_stamps = true}); }
TEST_F(Doctor, FindsASlowCamera) { expect_found("slow", {.period = std::chrono::milliseconds(400)}); }
TEST_F(Doctor, FindsAnotherEncoding) { expect_found("encoding", {.depth_encoding = "64FC1"}); }
TEST_F(Doctor, FindsAFrameThatIsNotMounted) { expect_found("unknown_frame", {.mounted_frame = "camera_link"}); }

TEST_F(Doctor, FindsStampsThatAreApart) {
  expect_found("stamps_apart", {.depth_late = std::chrono::milliseconds(150)});
}

TEST_F(Doctor, FindsCameraInfosThatDisagree) {
  expect_found("info_differs", {.spoil_depth_info = [](CameraInfo& info) { info.k()[0] = info.k()[4] = 90.0; }});
}

TEST_F(Doctor, FindsACameraInfoOfAnotherSize) {
  const auto double_size = [](CameraInfo& info) {
    info.width(2 * kWidth);
    info.height(2 * kHeight);
    info.k()[0] = info.k()[4] = 120.0;
  };
  expect_found("info_size", {.spoil_info = double_size, .spoil_depth_info = double_size});
}

TEST_F(Doctor, FindsACameraThatIsNotCalibrated) {
  const auto clear = [](CameraInfo& info) { info.k() = {}; };
  expect_found("info_empty", {.spoil_info = clear, .spoil_depth_info = clear});
}

TEST_F(Doctor, FindsAnUnknownModelOfTheLens) {
  expect_found("info_model", {.spoil_info = [](CameraInfo& info) { info.distortion_model("equidistant"); }});
}

TEST_F(Doctor, FindsACameraInfoOfAnotherFrame) {
  expect_found("info_frame", {.spoil_info = [](CameraInfo& info) { info.header().frame_id("elsewhere"); }});
}

TEST_F(Doctor, FindsAMountForEarlyReadersAlone) {
  // Published once, before the doctor comes, and so silent, too.
  const Camera camera(probe_, {.mount_qos = {.depth = 1}});
  const Answer answer = examine();
  EXPECT_THAT(answer.faults, Contains("not_latched")) << answer.log;
}

TEST_F(Doctor, FindsQosThatCannotMatch) {
  dds::Qos best_effort = topics::kColor.qos;
  best_effort.best_effort = true;
  TopicProbe other("reader");
  other.listen<Image>(topics::kDepth, [](Image&) {});
  other.participant().announce_graph();
  expect_found("reliability", {.image_qos = best_effort});
}

TEST_F(Doctor, FindsALatchedReaderOfWhatIsNot) {
  TopicProbe other("reader");
  dds::Topic<nav_msgs::msg::Odometry> latched = topics::kWheelOdometry;
  latched.qos.latched = true;
  other.listen<nav_msgs::msg::Odometry>(latched, [](auto&) {});
  auto& odometry = probe_.advertise(topics::kWheelOdometry);
  probe_.executor().every(std::chrono::milliseconds(50), [&] { odometry.publish({}); });
  expect_found("durability");
}

TEST_F(Doctor, FindsTwoPublishers) {
  TopicProbe other("other_camera");
  other.advertise(topics::kColorInfo);
  expect_found("two_publishers");
}

TEST_F(Doctor, FindsTwoTypes) {
  TopicProbe other("other");
  const dds::RawPublisher strange(other.participant(), "rt/camera/labels_of_mine", "a_msgs::msg::dds_::A_", "", {});
  const dds::RawPublisher stranger(probe_.participant(), "rt/camera/labels_of_mine", "b_msgs::msg::dds_::B_", "", {});
  expect_found("two_types");
}

TEST_F(Doctor, FindsATypeThatLapisDoesNotRead) {
  TopicProbe other("other");
  const dds::RawPublisher strange(other.participant(), "rt/odom", "a_msgs::msg::dds_::A_", "", {});
  expect_found("wrong_type");
}

TEST_F(Doctor, FindsTheDeclarationOfAnotherDistribution) {
  TopicProbe other("humble");
  const dds::RawPublisher strange(other.participant(), "rt/scan_like", "sensor_msgs::msg::dds_::Imu_", "RIHS01_00", {});
  expect_found("type_hash");
}

TEST_F(Doctor, FindsTwoRuns) {
  std::vector<std::unique_ptr<TopicProbe>> runs;
  for (const char* id : {"one", "two"}) {
    const InRun run(id);
    runs.push_back(std::make_unique<TopicProbe>(id));
    runs.back()->listen<rosgraph_msgs::msg::Clock>(topics::kClock, [](auto&) {});
  }
  expect_found("two_runs");
}

TEST_F(Doctor, FindsImagesThatComeCompressedAlone) {
  auto& images = probe_.advertise(topics::kCompressedColor);
  probe_.executor().every(kPeriod, [&] {
    sensor_msgs::msg::CompressedImage image;
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    image.header().stamp(messages::to_message(time::Time{std::chrono::nanoseconds(now).count()}));
    image.header().frame_id(kOpticalFrame);
    image.format("jpeg");
    images.publish(image);
  });
  expect_found("compressed_only", {.has_color = false});
}

TEST_F(Doctor, FindsLabelsWithoutNames) {
  auto& labels = probe_.advertise(topics::kLabels);
  probe_.executor().every(kPeriod, [&] { labels.publish({}); });
  expect_found("no_label_info");
}

// The writer keeps one image and sends slowly, so that the last of three images replaces those before it.
TEST_F(Doctor, FindsImagesThatAreLostOnTheWay) {
  if (!dds::compat::kHasFlowControllers) GTEST_SKIP() << "this Fast DDS has no flow controllers to lose images by";
  dds::ParticipantOptions options = participant_options("slow_camera");
  options.link = dds::LinkSettings{.message_bytes = 8'000,
                                   .large = {.bytes_per_period = 20'000, .pace_period_ms = 20, .depth = 1}};
  TopicProbe slow(options);
  dds::Qos newest = topics::kColor.qos;
  newest.depth = 1;
  const Camera camera(slow,
                      {.period = std::chrono::milliseconds(300), .row_bytes = 1200, .burst = 3, .image_qos = newest});
  probe_.executor().every(std::chrono::milliseconds(5), [&] { slow.executor().spin_once({}); });
  const Answer answer = examine();
  EXPECT_THAT(answer.faults, Contains("losses")) << answer.log;
}

TEST_F(Doctor, FindsSmallSocketBuffers) {
  const Camera camera(probe_, {});
  has_large_buffers_ = true;  // what is asked for is small
  EXPECT_THAT(examine({"--socket-buffer", "65536"}).faults, Contains("small_buffers"));
}

}  // namespace
}  // namespace lapis::test
