#pragma once

#include "common/geometry/se3.hpp"
#include "slam/core/frame/frame.hpp"

namespace lapis::slam::test {

/// 320 x 240 pixels, 90 degrees wide.
geometry::PinholeCamera small_camera();

/// What a camera sees inside a box of 6 x 4 x 6 m around the origin whose walls are a mosaic of random grey tiles.
/// Exact depth, no noise; the same for the same pose.
RgbdFrame render_room(const geometry::PinholeCamera& camera, const geometry::Pose& T_room_camera, time::Time stamp);

/// Pose of frame `index` on a gentle curve through the room: about 3 cm and 1 degree a frame.
geometry::Pose room_path(int index);

}  // namespace lapis::slam::test
