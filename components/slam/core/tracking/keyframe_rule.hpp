#pragma once

#include "common/geometry/se3.hpp"
#include "slam/core/config.hpp"

namespace lapis::slam {

/// Input of the key-frame rule.
struct KeyframeEvidence {
  int frames_since_keyframe = 0;
  int reference_landmarks = 0;  ///< landmarks of the reference key-frame
  int tracked_landmarks = 0;    ///< of these, inliers of this frame
  geometry::Pose T_reference_camera = geometry::Pose::Identity();
};

/// True when the frame should become a key-frame.
bool needs_keyframe(const KeyframeConfig& config, const KeyframeEvidence& evidence);

}  // namespace lapis::slam
