#include "slam/core/tracking/keyframe_rule.hpp"

namespace lapis::slam {

bool needs_keyframe(const KeyframeConfig& config, const KeyframeEvidence& evidence) {
  if (evidence.frames_since_keyframe < config.min_frames) return false;
  if (evidence.tracked_landmarks < config.min_tracked_share * evidence.reference_landmarks) return true;
  if (evidence.T_reference_camera.translation().norm() > config.max_translation_m) return true;
  return geometry::rotation_angle(evidence.T_reference_camera.linear()) > config.max_rotation_rad;
}

}  // namespace lapis::slam
