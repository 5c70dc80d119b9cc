#pragma once

#include "common/dds/topic.hpp"
#include "idl/sensor_msgs.hpp"
#include "idl/vision_msgs.hpp"

namespace lapis::topics {

// What a camera and a segmentation of its images publish.
inline constexpr dds::Topic<sensor_msgs::msg::Image> kColor{"/camera/color/image_raw", dds::kImage, "camera",
                                                            "15 or 30 Hz", "rgb8, bgr8, rgba8, bgra8 or mono8"};
inline constexpr dds::Topic<sensor_msgs::msg::CompressedImage> kCompressedColor{
    "/camera/color/image_raw/compressed", dds::kImage, "camera", "camera rate",
    "JPEG or PNG; read instead of image_raw with slam.input.color or segmenter.color: compressed"};
inline constexpr dds::Topic<sensor_msgs::msg::Image> kDepth{"/camera/depth/image_raw", dds::kImage, "camera",
                                                            "camera rate", "16UC1 in mm or 32FC1 in m; 0 = none"};
inline constexpr dds::Topic<sensor_msgs::msg::CameraInfo> kColorInfo{"/camera/color/camera_info", dds::kImageInfo,
                                                                     "camera", "camera rate", "intrinsics"};
inline constexpr dds::Topic<sensor_msgs::msg::CameraInfo> kDepthInfo{
    "/camera/depth/camera_info", dds::kImageInfo, "camera", "camera rate",
    "intrinsics; those of colour where depth is registered to it"};
inline constexpr dds::Topic<sensor_msgs::msg::Image> kLabels{
    "/camera/semantic/image_raw", dds::kImage, "camera, or a segmentation", "camera rate or less",
    "mono8 or mono16 class ids; 0 and the largest id = unlabelled"};
inline constexpr dds::Topic<sensor_msgs::msg::Image> kLabelConfidence{"/camera/semantic/confidence", dds::kImage,
                                                                      "camera, or a segmentation", "as the labels",
                                                                      "optional; 32FC1 or mono8"};
inline constexpr dds::Topic<vision_msgs::msg::LabelInfo> kLabelInfo{
    "/camera/semantic/label_info", dds::kLatched, "camera, or a segmentation", "once", "names of the class ids"};

}  // namespace lapis::topics
