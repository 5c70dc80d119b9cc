#include "sensor_replay/core/trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "synthetic_dataset.hpp"

namespace lapis::sensor_replay {
namespace {

using test::error_of;
using test::write_text;
using testing::HasSubstr;

constexpr time::Duration kLimit{20'000'000};

class TrajectoryFile : public testing::Test {
 protected:
  std::string error(const std::string& text) {
    write_text(file_, text);
    return error_of([&] { read_trajectory(file_); });
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "groundtruth.txt";
};

TEST_F(TrajectoryFile, ReadsTumOrder) {
  write_text(file_, "# comment\n1305031098.6659 1.3563 0.6305 1.6380 0.5 0.5 -0.5 0.5\n");
  const auto poses = read_trajectory(file_);
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0].stamp.nanoseconds, 1305031098665900000);
  EXPECT_TRUE(poses[0].T_world_camera.translation().isApprox(Eigen::Vector3d(1.3563, 0.6305, 1.6380), 1e-12));
  const Eigen::Matrix3d expected = Eigen::Quaterniond(0.5, 0.5, 0.5, -0.5).toRotationMatrix();
  EXPECT_TRUE(poses[0].T_world_camera.linear().isApprox(expected, 1e-12));
}

TEST_F(TrajectoryFile, ErrorsNameFileAndLine) {
  const std::string where = file_.string() + ":";
  EXPECT_THAT(error("0.1 0 0 0 0 0 0\n"), testing::StartsWith(where + "1: 7 fields instead of 8"));
  EXPECT_THAT(error("0.1 0 0 0 0 0 0 2\n"), HasSubstr(":1: quaternion of length 2"));
  EXPECT_THAT(error("0.1 0 nan 0 0 0 0 1\n"), HasSubstr(":1: \"nan\" is not a finite number"));
  EXPECT_THAT(error("0.2 0 0 0 0 0 0 1\n\n0.1 0 0 0 0 0 0 1\n"), HasSubstr(":3: time stamps are not sorted"));
  EXPECT_THAT(error("0.2 0 0 0 0 0 0 1\n0.2 0 0 0 0 0 0 1\n"), HasSubstr(":2: time stamps are not sorted or occur"));
}

TEST(Interpolate, AgreesWithTheConstantTwistBetweenTwoPoses) {
  // A turn about a fixed axis with proportional translation is what linear + slerp interpolation must reproduce
  // exactly.
  const Eigen::Vector3d axis = Eigen::Vector3d(0.2, -0.7, 0.4).normalized();
  const auto pose_at = [&](double share) {
    return geometry::make_pose(share * Eigen::Vector3d(1.0, 2.0, -3.0),
                               Eigen::Quaterniond(Eigen::AngleAxisd(0.9 * share, axis)));
  };
  const std::vector<StampedPose> ends{{time::Time{0}, pose_at(0.0)}, {time::Time{30'000'000}, pose_at(1.0)}};
  for (const double share : {0.0, 0.1, 0.5, 0.75, 1.0}) {
    const auto T = interpolate(ends, time::Time{static_cast<std::int64_t>(share * 30e6)}, kLimit);
    ASSERT_TRUE(T) << share;
    EXPECT_TRUE(T->isApprox(pose_at(share), 1e-9)) << share;
  }
}

TEST(Interpolate, TakesTheShortWayBetweenOppositeQuaternions) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond opposite(-q.w(), -q.x(), -q.y(), -q.z());
  const std::vector<StampedPose> ends{{time::Time{0}, geometry::make_pose({0, 0, 0}, q)},
                                      {time::Time{10}, geometry::make_pose({0, 0, 0}, opposite)}};
  const auto T = interpolate(ends, time::Time{5}, kLimit);
  ASSERT_TRUE(T);
  EXPECT_NEAR(geometry::rotation_angle(T->linear()), 0.1, 1e-9);
}

TEST(Interpolate, MakesNothingUp) {
  const geometry::Pose I = geometry::Pose::Identity();
  const std::vector<StampedPose> poses{{time::Time{1'000'000'000}, I}, {time::Time{2'000'000'000}, I}};
  EXPECT_FALSE(interpolate({}, time::Time{0}, kLimit));
  EXPECT_FALSE(interpolate(poses, time::Time{999'999'999}, kLimit)) << "before the first pose";
  EXPECT_FALSE(interpolate(poses, time::Time{2'000'000'001}, kLimit)) << "after the last pose";
  EXPECT_FALSE(interpolate(poses, time::Time{1'500'000'000}, kLimit)) << "in a gap";
  EXPECT_TRUE(interpolate(poses, time::Time{1'020'000'000}, kLimit)) << "at the limit";
  EXPECT_TRUE(interpolate(poses, time::Time{2'000'000'000}, kLimit)) << "at the last pose";
}

}  // namespace
}  // namespace lapis::sensor_replay
