#include "common/geometry/camera_mount.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace lapis::geometry {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2.0;

TEST(CameraMount, LevelMountAtTheOriginOnlyRenamesAxes) {
  const Pose T = T_base_camera({});
  EXPECT_EQ(T.linear() * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX()) << "optical forward is base forward";
  EXPECT_EQ(T.linear() * Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY()) << "optical right is base right";
  EXPECT_EQ(T.linear() * Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitZ()) << "optical down is base down";
  EXPECT_TRUE(T.translation().isZero());
}

TEST(CameraMount, OpticalFrameIsRollPitchYawOfRep103) {
  const Eigen::Matrix3d rpy =
      (Eigen::AngleAxisd(-kQuarterTurn, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.0, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(-kQuarterTurn, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_TRUE(T_link_optical().linear().isApprox(rpy, 1e-15));
}

TEST(CameraMount, PixelOnTheAxisHitsTheFloorWherePitchAndHeightSay) {
  for (const double pitch : {0.1, 0.5, 1.2}) {
    const CameraMount mount{1.3, pitch};
    const double range = mount.height_m / std::sin(pitch);
    const Eigen::Vector3d p_base = T_base_camera(mount) * Eigen::Vector3d(0.0, 0.0, range);
    EXPECT_NEAR(p_base.x(), mount.height_m / std::tan(pitch), 1e-12);
    EXPECT_NEAR(p_base.y(), 0.0, 1e-12);
    EXPECT_NEAR(p_base.z(), 0.0, 1e-12);
  }
}

TEST(CameraMount, ProductOfItsPartsIsAValidPose) {
  const CameraMount mount{0.4, -0.2};
  EXPECT_TRUE(is_valid(T_base_camera(mount)));
  EXPECT_TRUE(T_base_camera(mount).isApprox(T_base_link(mount) * T_link_optical(), 1e-15));
  EXPECT_EQ(T_base_link(mount).translation(), Eigen::Vector3d(0.0, 0.0, 0.4));
}

}  // namespace
}  // namespace lapis::geometry
