#pragma once

#include <cstdint>

#include "common/geometry/se3.hpp"

namespace lapis::planner {

struct Keyframe {
  std::uint64_t id = 0;
  geometry::Pose T_map_camera = geometry::Pose::Identity();  ///< camera optical frame
};

}  // namespace lapis::planner
