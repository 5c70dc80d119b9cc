// lapis_slam alone, fed with the kinds of cameras that there are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/messages/camera.hpp"
#include "common/topics/camera.hpp"
#include "tests/contract/slam/slam_contract.hpp"
#include "tests/support/boards.hpp"

namespace lapis::test {
namespace {

constexpr std::int64_t kStart_ns = 1'000'000'000;

/// slam and a camera of any rate, whose depth may have stamps of its own.
class SlamInputs : public SlamContract {
 protected:
  using SlamContract::SlamContract;

  struct Rate {
    double hz;
    double depth_offset;  // of the depth images' stamps, in periods
  };
  static time::Time stamp(double hz, double index) {
    return {kStart_ns + static_cast<std::int64_t>(std::llround(index / hz * 1e9))};
  }
  /// Another size of the images, then another lens.
  void expect_tracked_through_changes();
  /// Frame `index` of the slow motion; depth shows what there was to see at its own time.
  CameraFrame frame(const Rate& rate, int index) const {
    CameraFrame result = feed.frame(stamp(rate.hz, index), slow_motion(index));
    const double depth_index = index + rate.depth_offset;
    result.depth = feed.camera().depth(stamp(rate.hz, depth_index), slow_motion(depth_index));
    return result;
  }
  /// Sends frames and, when a further one has come, expects that each is tracked and where the camera is.
  void expect_all_tracked(const Rate& rate, int count) {
    for (int i = 0; i <= count; ++i) {
      feed.send(frame(rate, i));
      if (i > 0) {
        ASSERT_TRUE(wait_for_at_least(static_cast<std::size_t>(i))) << i << slam.log();
      }
    }
    ASSERT_GE(frames.size(), static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      const auto& answer = frames[static_cast<std::size_t>(i)];
      EXPECT_EQ(stamp_of(answer), stamp(rate.hz, i));
      EXPECT_EQ(answer.state(), kTracking) << i << " " << answer.reason();
      expect_pose(stamp(rate.hz, i), slow_motion(0), slow_motion(i));
    }
    EXPECT_EQ(count_of("dropped"), 0.0) << slam.log();
  }
  bool wait_for_at_least(std::size_t number) {
    return probe.wait_until([&] { return frames.size() >= number; });
  }
};

TEST_F(SlamInputs, FiveHertzWithDepthHalfAPeriodLater) { expect_all_tracked({5.0, 0.5}, 10); }
TEST_F(SlamInputs, SixtyHertzWithDepthHalfAPeriodLater) { expect_all_tracked({60.0, 0.5}, 20); }
TEST_F(SlamInputs, FifteenHertzWithDepthNearlyHalfAPeriodBefore) { expect_all_tracked({15.0, -0.45}, 10); }

TEST_F(SlamInputs, Mono8AndDepthInMetres) {
  for (int i = 0; i < 8; ++i) {
    CameraFrame sent = feed.frame(i);
    sensor_msgs::msg::Image mono = *sent.color;
    mono.encoding("mono8");
    mono.step(mono.width());
    mono.data().resize(mono.step() * mono.height());
    for (std::size_t p = 0; p < mono.data().size(); ++p) mono.data()[p] = sent.color->data()[3 * p];
    sent.color = mono;
    sent.depth = feed.camera().depth_metres(CameraFeed::stamp(i), slow_motion(i));
    ASSERT_TRUE(answers(sent, i)) << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
    expect_pose(CameraFeed::stamp(i), slow_motion(0), slow_motion(i));
  }
}

TEST_F(SlamInputs, BgraIsTheSameAsRgb) {
  for (int i = 0; i < 4; ++i) {
    CameraFrame sent = feed.frame(i);
    sensor_msgs::msg::Image bgra = *sent.color;
    bgra.encoding("bgra8");
    bgra.step(4 * bgra.width());
    bgra.data().assign(static_cast<std::size_t>(bgra.step()) * bgra.height(), 255);
    for (std::size_t p = 0; p < bgra.data().size() / 4; ++p) {
      for (std::size_t c = 0; c < 3; ++c) bgra.data()[4 * p + c] = sent.color->data()[3 * p + 2 - c];
    }
    sent.color = bgra;
    ASSERT_TRUE(answers(sent, i)) << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
    expect_pose(CameraFeed::stamp(i), slow_motion(0), slow_motion(i));
  }
}

TEST_F(SlamInputs, EveryThirdDepthImageMissingCostsThoseFramesOnly) {
  constexpr int kFrames = 15;
  constexpr int kMissing = 5;
  for (int i = 0; i < kFrames; ++i) {
    CameraFrame sent = feed.frame(i);
    if (i % 3 == 2) sent.depth.reset();
    feed.send(sent);
    if (i % 3 != 2) {
      ASSERT_TRUE(wait_for_answer(CameraFeed::stamp(i))) << i << slam.log();
    }
  }
  ASSERT_TRUE(track(kFrames));  // after it nothing can come for the last one
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kFrames + 1));
  for (int i = 0; i < kFrames; ++i) {
    const auto& answer = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(stamp_of(answer), CameraFeed::stamp(i));
    EXPECT_EQ(answer.state(), i % 3 == 2 ? kLost : kTracking) << i << " " << answer.reason();
    if (i % 3 == 2) {
      EXPECT_EQ(answer.reason(), "no depth image for a colour image");
    } else {
      expect_pose(CameraFeed::stamp(i), slow_motion(0), slow_motion(i));
    }
  }
  EXPECT_TRUE(wait_for_count("frames dropped: no depth image", kMissing));
  EXPECT_EQ(count_of("frames dropped"), kMissing);
}

TEST_F(SlamInputs, DepthWithoutColorIsCounted) {
  for (int i = 0; i < 9; ++i) {
    CameraFrame sent = feed.frame(i);
    if (i % 3 == 1) sent.color.reset();
    feed.send(sent);
    if (i % 3 != 1) {
      ASSERT_TRUE(wait_for_answer(CameraFeed::stamp(i))) << i << slam.log();
    }
  }
  EXPECT_EQ(frames.size(), 6U);
  EXPECT_TRUE(wait_for_count("depth dropped: no colour image near it", 3)) << slam.log();
  EXPECT_EQ(count_of("dropped"), 3.0);
}

TEST_F(SlamInputs, StreamThatIsMissingIsNamedWithinTwoSeconds) {
  const auto& status = probe.collect(topics::kSlamStatus);
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; slam.log().find("nothing comes on rt/camera/depth/image_raw") == std::string::npos; ++i) {
    CameraFrame sent = feed.frame(i);
    sent.depth.reset();
    feed.send(sent);
    ASSERT_LT(Seconds(std::chrono::steady_clock::now() - begin).count(), 2.0) << slam.log();
    probe.wait_until([] { return false; }, Seconds(0.1));
  }
  EXPECT_EQ(slam.log().find("nothing comes on rt/camera/color"), std::string::npos);
  EXPECT_TRUE(probe.wait_until([&] {
    return !status.empty() && status.back().reason().find("rt/camera/depth/image_raw") != std::string::npos;
  })) << slam.log();
  EXPECT_TRUE(newest_values(diagnostics, "slam").contains("silent rt/camera/depth/image_raw"));
  feed.send(feed.frame(1000));
  EXPECT_TRUE(slam.wait_for_line("rt/camera/depth/image_raw comes again")) << slam.log();
}

/// With dds.color_transport: compressed.
class SlamCompressedInput : public SlamInputs {
 protected:
  SlamCompressedInput() : SlamInputs({"--set", "dds.color_transport=compressed"}) {}

  bool is_matched() const override { return color_.matched() > 0; }
  void send(int index, const std::string& extension, const std::function<void(std::vector<std::uint8_t>&)>& change) {
    CameraFrame sent = feed.frame(index);
    cv::Mat pixels(static_cast<int>(sent.color->height()), static_cast<int>(sent.color->width()), CV_8UC3,
                   sent.color->data().data());
    sensor_msgs::msg::CompressedImage message;
    message.header(sent.color->header());
    message.format("rgb8; " + extension.substr(1) + " compressed bgr8");
    cv::imencode(extension, pixels, message.data());
    change(message.data());
    color_.publish(message);
    sent.color.reset();
    feed.send(sent);
  }

 private:
  dds::Publisher<sensor_msgs::msg::CompressedImage>& color_ = probe.advertise(topics::kCompressedColor);
};

TEST_F(SlamCompressedInput, JpegAndPngAreTrackedAndDamagedOnesAreNot) {
  const auto as_it_is = [](auto& /*bytes*/) {};
  const auto halve = [](auto& bytes) { bytes.resize(bytes.size() / 2); };
  const auto spoil = [](auto& bytes) { bytes.assign(500, 7); };
  for (int i = 0; i < 12; ++i) {
    const bool is_bad = i == 6 || i == 8;
    const std::string extension = i % 4 < 2 ? ".jpg" : ".png";
    if (i == 6) {
      send(i, ".jpg", halve);
    } else if (i == 8) {
      send(i, extension, spoil);
    } else {
      send(i, extension, as_it_is);
    }
    ASSERT_TRUE(wait_for_answer(CameraFeed::stamp(i))) << i << slam.log();
    EXPECT_EQ(frames.back().state(), is_bad ? kLost : kTracking) << i << " " << frames.back().reason();
    if (!is_bad) expect_pose(CameraFeed::stamp(i), slow_motion(0), slow_motion(i));
  }
  EXPECT_TRUE(wait_for_count("compressed colour image is damaged", 1));
  EXPECT_TRUE(wait_for_count("neither JPEG nor PNG", 1));
}

/// With dds.depth_transport: compressed.
class SlamCompressedDepth : public SlamInputs {
 protected:
  SlamCompressedDepth() : SlamInputs({"--set", "dds.depth_transport=compressed"}) {}

  bool is_matched() const override { return depth_.matched() > 0; }
  void send(int index) {
    CameraFrame sent = feed.frame(index);
    const cv::Mat pixels(static_cast<int>(sent.depth->height()), static_cast<int>(sent.depth->width()), CV_16UC1,
                         sent.depth->data().data());
    std::vector<std::uint8_t> png;
    cv::imencode(".png", pixels, png);
    sensor_msgs::msg::CompressedImage message;
    message.header(sent.depth->header());
    message.format("16UC1; compressedDepth png");
    message.data().resize(12);
    message.data().insert(message.data().end(), png.begin(), png.end());
    depth_.publish(message);
    sent.depth.reset();
    feed.send(sent);
  }

 private:
  dds::Publisher<sensor_msgs::msg::CompressedImage>& depth_ = probe.advertise(topics::kCompressedDepth);
};

TEST_F(SlamCompressedDepth, IsTracked) {
  for (int i = 0; i < 6; ++i) {
    send(i);
    ASSERT_TRUE(wait_for_answer(CameraFeed::stamp(i))) << i << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
    expect_pose(CameraFeed::stamp(i), slow_motion(0), slow_motion(i));
  }
}

/// With the lens of a wide camera: the corners lie 24 pixels off.
class SlamDistortedInput : public SlamInputs {
 protected:
  SlamDistortedInput() : SlamInputs({}, SyntheticCamera(320, 240, {-0.28, 0.07, 0.0008, -0.0006, 0.0})) {}
};

TEST_F(SlamDistortedInput, TrajectoryIsTheTrueOne) {
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(track(i)) << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << frames.back().reason();
    expect_pose(CameraFeed::stamp(i), slow_motion(0), slow_motion(i));
  }
}

void SlamInputs::expect_tracked_through_changes() {
  const SyntheticCamera large(400, 300);
  const SyntheticCamera wide(320, 240, {-0.28, 0.07, 0.0008, -0.0006, 0.0});
  for (int i = 0; i < 15; ++i) {
    const SyntheticCamera& camera = i < 5 ? feed.camera() : (i < 10 ? large : wide);
    const time::Time at = CameraFeed::stamp(i);
    const CameraFrame sent{camera.color(at, slow_motion(i)), camera.depth(at, slow_motion(i)), {}, camera.info(at)};
    ASSERT_TRUE(answers(sent, i)) << slam.log();
    EXPECT_EQ(frames.back().state(), kTracking) << i << " " << frames.back().reason();
    EXPECT_EQ(frames.back().session(), frames.front().session());
    expect_pose(at, slow_motion(0), slow_motion(i));
  }
}

TEST_F(SlamInputs, CalibrationMayChange) { expect_tracked_through_changes(); }

/// Boards before a wall, of whose depth nobody says that it is of another camera, 3 cm to the left.
class SlamDepthCalibration : public SlamInputs {
 protected:
  explicit SlamDepthCalibration(const std::vector<std::string>& arguments = {}) : SlamInputs(arguments) {}

  CameraFrame frame_of_boards(time::Time at) const {
    const auto boards = make_boards(2);
    CameraFrame frame{feed.camera().color(at, slow_motion(0)),
                      feed.camera().depth_metres(at, slow_motion(0)),
                      {},
                      feed.camera().info(at)};
    geometry::PinholeCamera camera = messages::lens_camera(*frame.info)->pinhole;
    const auto gray = gray_of(boards, camera);
    for (std::size_t i = 0; i < frame.color->data().size(); ++i) frame.color->data()[i] = gray.pixels[i / 3];
    camera.fx *= 1.11;
    camera.fy *= 1.11;
    const auto depth = depth_of(boards, camera, {-0.03, 0.0, 0.0});
    std::memcpy(frame.depth->data().data(), depth.pixels.data(), frame.depth->data().size());
    return frame;
  }
};

TEST_F(SlamDepthCalibration, WhatContradictsTheImagesIsReported) {
  constexpr int kViews = 8, kBetween = 7;  // frames, 0.23 s
  for (int i = 0; i < kViews; ++i) {
    ASSERT_TRUE(answers(frame_of_boards(CameraFeed::stamp(kBetween * i)), kBetween * i)) << slam.log();
  }
  EXPECT_THAT(slam.log(), ::testing::HasSubstr("depth seems to be of a camera with fx 3"));
  EXPECT_THAT(slam.log(), ::testing::HasSubstr("cm to the left of colour"));
  EXPECT_THAT(slam.log(), ::testing::HasSubstr("set slam.depth_calibration: estimate"));
}

class SlamDepthEstimate : public SlamDepthCalibration {
 protected:
  SlamDepthEstimate() : SlamDepthCalibration({"--set", "slam.depth_calibration=estimate"}) {}

  const std::vector<sensor_msgs::msg::CameraInfo>& estimates = probe.collect(topics::kDepthEstimate);
};

TEST_F(SlamDepthEstimate, CalibrationMayChange) { expect_tracked_through_changes(); }

TEST_F(SlamDepthEstimate, IsPublishedWithTheFirstFrame) {
  ASSERT_TRUE(answers(frame_of_boards(CameraFeed::stamp(0)), 0)) << slam.log();
  ASSERT_TRUE(probe.wait_until([&] { return !estimates.empty(); })) << slam.log();
  const auto& info = estimates.front();
  EXPECT_EQ(stamp_of(info), CameraFeed::stamp(0));
  EXPECT_NEAR(info.k()[0], 1.11 * feed.camera().info(CameraFeed::stamp(0)).k()[0], 1.0);
  EXPECT_NEAR(-info.p()[3] / info.p()[0], -0.03, 0.005);
}

}  // namespace
}  // namespace lapis::test
