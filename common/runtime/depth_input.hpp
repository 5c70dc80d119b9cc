#pragma once

#include "common/messages/compressed_depth.hpp"
#include "common/runtime/stamped_input.hpp"
#include "common/topics/camera.hpp"

namespace lapis::runtime {

/// The depth images, of the topic that dds.depth_transport chooses. `capacity`: number of them that may wait.
inline StampedInput<sensor_msgs::msg::Image> depth_input(Context& context, std::size_t capacity) {
  using Depth = StampedInput<sensor_msgs::msg::Image>;
  if (!context.options().is_depth_compressed) return Depth(context, topics::kDepth, "depth", capacity);
  const std::function decode = messages::unpack_depth;
  return Depth(context, topics::kCompressedDepth, "depth", capacity, decode);
}

}  // namespace lapis::runtime
