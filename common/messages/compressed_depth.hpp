#pragma once

#include "common/messages/converted.hpp"
#include "idl/sensor_msgs.hpp"

namespace lapis::messages {

/// The depth image that ROS's transport compressedDepth has packed: a header of 12 bytes (kind, two parameters), then a
/// PNG of 16 bits per pixel. 16UC1 [mm] stays as it is; a 32FC1 image [m] comes as a / depth + b, with both parameters
/// in the header, and 0 for none. Refused with the reason when the image is damaged, has more than kMostDecodedPixels,
/// or packed as RVL.
Converted<sensor_msgs::msg::Image> unpack_depth(const sensor_msgs::msg::CompressedImage& message);

}  // namespace lapis::messages
