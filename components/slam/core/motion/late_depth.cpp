#include "slam/core/motion/late_depth.hpp"

#include <algorithm>

#include "common/images/depth_registration.hpp"

namespace lapis::slam {

void LateDepth::add(const RgbdFrame& frame) {
  color_stamp_ = frame.stamp;
  if (!images_.empty() && !(images_.back().camera == frame.camera)) images_.clear();
  images_.push_back({frame.stamp + frame.depth_delay, frame.camera, frame.depth});
  while (images_.size() > 1 && images_[1].stamp <= color_stamp_) images_.pop_front();
}

const MeasuredDepth& LateDepth::nearest() const {
  const auto distance = [this](const MeasuredDepth& depth) {
    const time::Duration after = depth.stamp - color_stamp_;
    return after > time::Duration{} ? 2 * after.nanoseconds : -after.nanoseconds;
  };
  return *std::min_element(images_.begin(), images_.end(),
                           [&](const MeasuredDepth& a, const MeasuredDepth& b) { return distance(a) < distance(b); });
}

geometry::DepthImage seen_from(const geometry::Pose& T_color_depth, const MeasuredDepth& depth) {
  const geometry::LensCamera camera{depth.camera, {}};
  return images::DepthRegistration({camera, camera, T_color_depth})(depth.image);
}

}  // namespace lapis::slam
