#pragma once

#include <optional>
#include <vector>

#include <opencv2/features2d.hpp>

#include "common/geometry/se3.hpp"
#include "slam/core/frame/frame.hpp"

namespace lapis::slam::benchmark {

/// The chain that anybody writes first with OpenCV, to compare with: 1000 ORB features, brute-force matching with
/// cross-check against the frame before, pose by PnP and RANSAC with the depth of that frame.
class PlainChain {
 public:
  /// T_previous_camera, or none when there is no previous frame or no pose explains the matches.
  std::optional<geometry::Pose> process(const RgbdFrame& frame);

 private:
  struct Features {
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    geometry::DepthImage depth;
  };
  std::optional<geometry::Pose> align(const geometry::PinholeCamera& camera, const Features& features) const;

  cv::Ptr<cv::ORB> orb_ = cv::ORB::create(1000);
  cv::BFMatcher matcher_{cv::NORM_HAMMING, true};
  Features previous_;
};

}  // namespace lapis::slam::benchmark
