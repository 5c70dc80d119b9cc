// The profiles of config/cameras, each against a camera with the names, encodings and QoS of its driver
// (docs/cameras.md).
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/synthetic_camera.hpp"

namespace lapis::test {
namespace {

using sensor_msgs::msg::Image;

struct Driver {
  const char* profile;
  const char* color;
  const char* color_info;
  const char* depth;
  const char* depth_info;  ///< the same as color_info: one message for both images
  const char* color_encoding;
  const char* depth_encoding;
  bool has_depth_view = false;  ///< depth is of a camera beside that of colour
  bool is_best_effort = false;
};

const Driver kDrivers[] = {
    {"realsense", "/camera/camera/color/image_raw", "/camera/camera/color/camera_info",
     "/camera/camera/depth/image_rect_raw", "/camera/camera/depth/camera_info", "rgb8", "16UC1", true},
    {"realsense_aligned", "/camera/camera/color/image_raw", "/camera/camera/color/camera_info",
     "/camera/camera/aligned_depth_to_color/image_raw", "/camera/camera/aligned_depth_to_color/camera_info", "rgb8",
     "16UC1"},
    {"realsense_infrared", "/camera/camera/infra1/image_rect_raw", "/camera/camera/infra1/camera_info",
     "/camera/camera/depth/image_rect_raw", "/camera/camera/depth/camera_info", "mono8", "16UC1"},
    {"orbbec", "/camera/color/image_raw", "/camera/color/camera_info", "/camera/depth/image_raw",
     "/camera/depth/camera_info", "rgb8", "16UC1", true},
    {"astra", "/camera/color/image_raw", "/camera/color/camera_info", "/camera/depth/image_raw",
     "/camera/depth/camera_info", "rgb8", "16UC1", true, true},
    {"azure_kinect", "/rgb/image_raw", "/rgb/camera_info", "/depth_to_rgb/image_raw", "/depth_to_rgb/camera_info",
     "bgra8", "16UC1"},
    {"zed", "/zed/zed_node/rgb/color/rect/image", "/zed/zed_node/rgb/color/rect/camera_info",
     "/zed/zed_node/depth/depth_registered", "/zed/zed_node/depth/camera_info", "bgra8", "32FC1"},
    {"zed_5_0", "/zed/zed_node/rgb/image_rect_color", "/zed/zed_node/rgb/camera_info",
     "/zed/zed_node/depth/depth_registered", "/zed/zed_node/depth/camera_info", "bgra8", "32FC1"},
    {"oak_d", "/oak/rgb/image_raw", "/oak/rgb/camera_info", "/oak/stereo/image_raw", "/oak/stereo/camera_info", "bgr8",
     "16UC1"},
    {"gazebo", "/rgbd_camera/image", "/rgbd_camera/camera_info", "/rgbd_camera/depth_image", "/rgbd_camera/camera_info",
     "rgb8", "32FC1"},
    {"isaac_sim", "/rgb", "/camera_info", "/depth", "/camera_info", "rgb8", "32FC1"},
};

/// The rgb8 image with another encoding: the order of channels of `encoding`, in which a letter is a channel.
Image with_channels(const Image& rgb, const std::string& encoding, const std::string& channels) {
  Image out = rgb;
  out.encoding(encoding);
  out.step(static_cast<std::uint32_t>(out.width() * channels.size()));
  out.data().clear();
  for (std::size_t pixel = 0; pixel < rgb.data().size(); pixel += 3) {
    for (const char channel : channels) {
      const auto at = std::string("rgb").find(channel);
      out.data().push_back(at == std::string::npos ? std::uint8_t{255} : rgb.data()[pixel + at]);
    }
  }
  return out;
}

Image encoded(const Image& rgb, const std::string& encoding) {
  if (encoding == "bgr8") return with_channels(rgb, encoding, "bgr");
  if (encoding == "bgra8") return with_channels(rgb, encoding, "bgra");
  if (encoding == "mono8") return with_channels(rgb, encoding, "g");
  return rgb;
}

/// Where a depth camera of its own is: 2.5 cm to the right of colour.
geometry::Pose T_color_depth() { return geometry::make_pose({0.025, 0.0, 0.0}, Eigen::Quaterniond::Identity()); }

dds::ParticipantOptions driver_options(const Driver& driver) {
  auto options = participant_options("driver");
  if (driver.is_best_effort) options.sensor_qos = dds::SensorQos::kBestEffort;
  return options;
}

/// A camera with the topics of a driver.
class DriverFeed {
 public:
  explicit DriverFeed(const Driver& driver)
      : driver_(driver), probe_(driver_options(driver)), color_(probe_.advertise(named(topics::kColor, driver.color))),
        depth_(probe_.advertise(named(topics::kDepth, driver.depth))),
        color_info_(probe_.advertise(named(topics::kColorInfo, driver.color_info))) {
    if (!has_one_info()) depth_info_ = &probe_.advertise(named(topics::kDepthInfo, driver.depth_info));
    auto mount = camera_mount();
    std_msgs::msg::Header header;
    header.frame_id(SyntheticCamera::kOpticalFrame);
    mount.transforms().push_back(messages::stamped_transform(header, kDepthFrame, T_color_depth()));
    probe_.advertise(topics::kStaticTransforms).publish(mount);
  }

  TopicProbe& probe() { return probe_; }
  /// True when slam, mapper and controller read what they need; the controller reads no camera info of colour.
  bool is_read() const {
    const bool is_color_read = color_.matched() >= 1 && color_info_.matched() >= 2;
    return is_color_read && depth_.matched() >= 3 && (depth_info_ == nullptr || depth_info_->matched() >= 3);
  }
  void send(int index) {
    const time::Time stamp = CameraFeed::stamp(index);
    const geometry::Pose T_box_camera = slow_motion(index);
    auto info = camera_.info(stamp);
    info.header().frame_id(SyntheticCamera::kOpticalFrame);
    color_info_.publish(info);
    Image color = encoded(camera_.color(stamp, T_box_camera), driver_.color_encoding);
    color.header().frame_id(SyntheticCamera::kOpticalFrame);
    const SyntheticCamera& view = driver_.has_depth_view ? depth_camera_ : camera_;
    const geometry::Pose T_box_depth = driver_.has_depth_view ? T_box_camera * T_color_depth() : T_box_camera;
    const bool is_in_m = std::string(driver_.depth_encoding) == "32FC1";
    Image depth = is_in_m ? view.depth_metres(stamp, T_box_depth) : view.depth(stamp, T_box_depth);
    const char* depth_frame = driver_.has_depth_view ? kDepthFrame : SyntheticCamera::kOpticalFrame;
    depth.header().frame_id(depth_frame);
    if (depth_info_ != nullptr) {
      auto depth_info = view.info(stamp);
      depth_info.header().frame_id(depth_frame);
      depth_info_->publish(depth_info);
    }
    color_.publish(color);
    depth_.publish(depth);
  }

 private:
  static constexpr const char* kDepthFrame = "depth_optical_frame";

  template <class Message>
  static dds::Topic<Message> named(dds::Topic<Message> topic, const char* name) {
    topic.name = name;
    return topic;
  }
  bool has_one_info() const { return std::string(driver_.color_info) == driver_.depth_info; }

  Driver driver_;
  SyntheticCamera camera_;
  SyntheticCamera depth_camera_{300, 220};
  TopicProbe probe_;
  dds::Publisher<Image>& color_;
  dds::Publisher<Image>& depth_;
  dds::Publisher<sensor_msgs::msg::CameraInfo>& color_info_;
  dds::Publisher<sensor_msgs::msg::CameraInfo>* depth_info_ = nullptr;
};

class Profile : public ::testing::TestWithParam<Driver> {};

TEST_P(Profile, CameraOfItsDriverIsReadAndTracked) {
  const std::vector<std::string> arguments{"--config", std::string(LAPIS_CAMERAS) + "/" + GetParam().profile + ".yaml"};
  DriverFeed driver(GetParam());
  const auto& frames = driver.probe().collect(topics::kTrackedFrame);
  const auto& odometry = driver.probe().collect(topics::kSlamOdometry);
  const auto& diagnostics = driver.probe().collect(topics::kDiagnostics);
  ChildProcess slam("lapis_slam", arguments);
  ChildProcess mapper("lapis_semantic_mapper", arguments);
  ChildProcess controller("lapis_controller", arguments);
  const auto logs = [&] { return slam.log() + mapper.log() + controller.log(); };
  ASSERT_TRUE(driver.probe().wait_until([&] { return driver.is_read(); }, Seconds(20))) << logs();
  for (const char* name : {"slam", "semantic_mapper", "controller"}) {
    ASSERT_TRUE(driver.probe().wait_until_known_by(name)) << logs();
  }
  constexpr int kFrames = 6;
  for (int i = 0; i < kFrames; ++i) {
    driver.send(i);
    const auto is_answered = [&] {
      return !frames.empty() && messages::from_message(frames.back().header().stamp()) == CameraFeed::stamp(i) &&
             odometry.size() == frames.size();
    };
    ASSERT_TRUE(driver.probe().wait_until(is_answered)) << i << logs();
    EXPECT_EQ(frames.back().state(), lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING) << frames.back().reason();
  }
  const auto moved =
      *messages::from_message(odometry.front().pose().pose()) *
      (T_base_camera() * slow_motion(0).inverse() * slow_motion(kFrames - 1) * T_base_camera().inverse());
  const auto error = moved.inverse() * *messages::from_message(odometry.back().pose().pose());
  EXPECT_LT(error.translation().norm(), 0.02);
  for (const char* name : {"slam", "semantic_mapper", "controller"}) {
    const auto values = [&] { return newest_values(diagnostics, name); };
    const bool has_worked =
        driver.probe().wait_until([&] { return values().contains("frames") || std::string(name) == "slam"; });
    EXPECT_TRUE(has_worked) << name << logs();
    EXPECT_EQ(sum_of(values(), "dropped"), 0.0) << name << logs();
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, Profile, ::testing::ValuesIn(kDrivers),
                         [](const auto& driver) { return std::string(driver.param.profile); });

TEST(Profiles, EachHasACameraHere) {
  std::set<std::string> files, drivers;
  for (const auto& entry : std::filesystem::directory_iterator(LAPIS_CAMERAS)) {
    if (entry.path().extension() == ".yaml") files.insert(entry.path().stem());
  }
  for (const Driver& driver : kDrivers) drivers.insert(driver.profile);
  EXPECT_EQ(files, drivers);
}

}  // namespace
}  // namespace lapis::test
