#include "sensor_replay/camera_yaml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "synthetic_dataset.hpp"

namespace lapis::sensor_replay {
namespace {

using test::error_of;
using test::write_text;
using testing::HasSubstr;

class CameraYaml : public testing::Test {
 protected:
  CameraFile read(const std::string& text) {
    write_text(file_, text);
    return read_camera_file(file_);
  }
  std::string error(const std::string& text) {
    return error_of([&] { read(text); });
  }
  // The valid file with one piece of its text replaced.
  std::string error_with(const std::string& old_text, const std::string& new_text) {
    std::string text = test::kCameraFile;
    return error(text.replace(text.find(old_text), old_text.size(), new_text));
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "camera.yaml";
};

TEST_F(CameraYaml, ReadsEveryKey) {
  const CameraFile camera = read(std::string(test::kCameraFile) + "camera_height: 1.5\npitch_down_deg: 8\n");
  EXPECT_EQ(camera.camera, (geometry::PinholeCamera{32, 24, 20.0, 21.0, 15.5, 11.5}));
  EXPECT_EQ(camera.depth_scale, 1000.0);
  EXPECT_EQ(camera.fps, 10.0);
  EXPECT_EQ(camera.mount.height_m, 1.5);
  EXPECT_NEAR(camera.mount.pitch_down_rad, 8.0 * std::numbers::pi / 180.0, 1e-15);
}

TEST_F(CameraYaml, MountAndDistortionMayBeAbsent) {
  const CameraFile camera =
      read("{width: 640, height: 480, fx: 5e2, fy: 500, cx: 1, cy: 2, depth_scale: 5000, fps: 30}");
  EXPECT_EQ(camera.mount.height_m, 0.0);
  EXPECT_EQ(camera.mount.pitch_down_rad, 0.0);
  EXPECT_EQ(camera.distortion, (std::array<double, 5>{}));
}

TEST_F(CameraYaml, ADepthCameraOfItsOwnHasCalibrationAndPlace) {
  EXPECT_FALSE(read(test::kCameraFile).depth_camera);
  const std::string depth =
      std::string(test::kCameraFile) + "depth: {width: 64, height: 48, fx: 50, fy: 51, cx: 31, cy: 23";
  const auto plain = read(depth + "}\n").depth_camera;
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->camera.pinhole, (geometry::PinholeCamera{64, 48, 50.0, 51.0, 31.0, 23.0}));
  EXPECT_FALSE(plain->camera.is_distorted());
  EXPECT_TRUE(plain->T_color_depth.isApprox(geometry::Pose::Identity()));
  const auto whole =
      read(depth + ", distortion: [0.1, 0, 0, 0, 0], position: [-0.025, 0.001, 0], rpy_deg: [0, 0, 90]}\n")
          .depth_camera;
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->camera.distortion[0], 0.1);
  EXPECT_TRUE((whole->T_color_depth * Eigen::Vector3d(1.0, 0.0, 2.0)).isApprox(Eigen::Vector3d(-0.025, 1.001, 2.0)));
  EXPECT_THAT(error(depth + ", postion: [0, 0, 0]}\n"), HasSubstr(":10: unknown key \"postion\"; known are width"));
  EXPECT_THAT(error(depth + ", position: [0, 0]}\n"), HasSubstr("position: must be three numbers [x, y, z]"));
  EXPECT_THAT(error(std::string(test::kCameraFile) + "depth: {width: 64}\n"), HasSubstr("key \"height\" is missing"));
  EXPECT_THAT(error(std::string(test::kCameraFile) + "depth: 3\n"), HasSubstr("must be a list of"));
}

TEST_F(CameraYaml, KeyErrorsNameFileLineAndKey) {
  EXPECT_THAT(error(std::string(test::kCameraFile) + "deph_scale: 1\n"),
              testing::AllOf(HasSubstr(file_.string() + ":10: unknown key \"deph_scale\""), HasSubstr("depth_scale")));
  EXPECT_THAT(error(std::string(test::kCameraFile) + "fx: 1\n"), HasSubstr(":10: key \"fx\" occurs twice"));
  EXPECT_THAT(error_with("fy: 21.0\n", ""), HasSubstr(file_.string() + ": key \"fy\" is missing"));
  EXPECT_THAT(error(""), HasSubstr("must be a list of"));
  EXPECT_THAT(error("just text"), HasSubstr("must be a list of"));
  EXPECT_THAT(error("width: 640\n  height: [\n"), HasSubstr("camera.yaml:2: not valid YAML"));
  EXPECT_THAT(error("\n[1]: 2\n"), HasSubstr(":2: unknown key"));
}

TEST_F(CameraYaml, ValueErrorsNameLineKeyValueAndBounds) {
  EXPECT_THAT(error_with("fx: 20.0", "fx: 0.0"),
              HasSubstr("camera.yaml:3: fx: must be a number from 1 to 100000, not \"0.0\""));
  EXPECT_THAT(error_with("width: 32", "width: 32.5"), HasSubstr("camera.yaml:1: width: must be a whole number"));
  EXPECT_THAT(error_with("width: 32", "width: -32"), HasSubstr("camera.yaml:1: width: must be a number from 16"));
  EXPECT_THAT(error_with("cx: 15.5", "cx: 400"), HasSubstr("camera.yaml:5: cx: must be a number from 0 to 32"));
  EXPECT_THAT(error_with("depth_scale: 1000.0", "depth_scale: .nan"), HasSubstr("depth_scale: must be"));
  EXPECT_THAT(error_with("depth_scale: 1000.0", "depth_scale: [1]"), HasSubstr("camera.yaml:8: depth_scale: must be"));
  EXPECT_THAT(error_with("fps: 10.0", "fps: fast"), HasSubstr("camera.yaml:9: fps: must be a number"));
  EXPECT_THAT(error_with("fps: 10.0", "fps:"), HasSubstr("fps: must be a number"));
  EXPECT_THAT(error_with("[0, 0, 0, 0, 0]", "[0, 0, 0, 0]"), HasSubstr("camera.yaml:7: distortion: must be five"));
  EXPECT_THAT(error_with("[0, 0, 0, 0, 0]", "[0, 0, 0, 0, x]"),
              HasSubstr("camera.yaml:7: distortion: must be a number"));
  EXPECT_THAT(error_with("fps: 10.0", "fps: 10.0\npitch_down_deg: 91"), HasSubstr("pitch_down_deg: must be"));
  EXPECT_THAT(error_with("fps: 10.0", "fps: 10.0\ncamera_height: -1"), HasSubstr("camera_height: must be"));
}

TEST_F(CameraYaml, MissingFileSaysWhatToWriteAndThatIsValid) {
  const auto sequence = folder_.path() / "rgbd_dataset_freiburg1_xyz";
  const std::string message = error_of([&] { read_camera_file(sequence / "camera.yaml"); });
  EXPECT_THAT(message, HasSubstr((sequence / "camera.yaml").string() + ": not found"));
  EXPECT_EQ(message.find('\n'), std::string::npos);

  const CameraFile example = read(message.substr(message.find('{')));
  EXPECT_EQ(example.camera.fx, 517.3);
  EXPECT_EQ(example.depth_scale, 5000.0);
}

TEST_F(CameraYaml, EveryExampleIsValid) {
  for (const char* name : {"freiburg1", "rgbd_dataset_freiburg2_desk", "freiburg3_office", "mine"}) {
    EXPECT_EQ(error(example_camera_file(name)), "") << name;
  }
}

}  // namespace
}  // namespace lapis::sensor_replay
