#include "tests/benchmark/slam/plain_chain.hpp"

#include <cmath>
#include <utility>

#include <opencv2/calib3d.hpp>

namespace lapis::slam::benchmark {
namespace {

constexpr std::size_t kMinMatches = 6;

}  // namespace

std::optional<geometry::Pose> PlainChain::process(const RgbdFrame& frame) {
  const cv::Mat view(frame.gray.height, frame.gray.width, CV_8UC1, const_cast<std::uint8_t*>(frame.gray.pixels.data()));
  Features features;
  orb_->detectAndCompute(view, cv::noArray(), features.points, features.descriptors);
  features.depth = frame.depth;
  auto T_previous_camera = align(frame.camera, features);
  previous_ = std::move(features);
  return T_previous_camera;
}

std::optional<geometry::Pose> PlainChain::align(const geometry::PinholeCamera& camera, const Features& features) const {
  if (features.points.empty() || previous_.points.empty()) return std::nullopt;
  std::vector<cv::DMatch> matches;
  matcher_.match(features.descriptors, previous_.descriptors, matches);
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const cv::DMatch& match : matches) {
    const cv::Point2f& before = previous_.points[static_cast<std::size_t>(match.trainIdx)].pt;
    const double z = previous_.depth(static_cast<int>(std::lround(before.x)), static_cast<int>(std::lround(before.y)));
    if (!(z > 0.0)) continue;
    const Eigen::Vector3d p = camera.unproject(before.x, before.y, z);
    points.emplace_back(p.x(), p.y(), p.z());
    pixels.emplace_back(features.points[static_cast<std::size_t>(match.queryIdx)].pt);
  }
  if (points.size() < kMinMatches) return std::nullopt;
  const cv::Matx33d K(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  cv::Vec3d rotation;
  cv::Vec3d translation;
  if (!cv::solvePnPRansac(points, pixels, K, cv::noArray(), rotation, translation)) return std::nullopt;
  geometry::Pose T_camera_previous = geometry::Pose::Identity();
  T_camera_previous.linear() = geometry::so3_exp({rotation[0], rotation[1], rotation[2]});
  T_camera_previous.translation() = Eigen::Vector3d(translation[0], translation[1], translation[2]);
  return T_camera_previous.inverse();
}

}  // namespace lapis::slam::benchmark
