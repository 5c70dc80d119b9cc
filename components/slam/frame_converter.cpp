#include "slam/frame_converter.hpp"

#include "common/images/encoded_image.hpp"
#include "common/topics/camera.hpp"

namespace lapis::slam {
namespace {

using messages::size_problem;
using Gray = messages::Converted<geometry::GrayImage>;

Gray to_gray(const sensor_msgs::msg::Image& color, const geometry::PinholeCamera& camera) {
  auto gray = messages::to_gray(color);
  if (!gray) return gray;
  const auto problem = size_problem("colour", gray->width, gray->height, camera);
  return problem.empty() ? std::move(gray) : Gray::refused(problem);
}

/// The size is compared before anything is decoded, because a few bytes may announce any number of pixels.
Gray to_gray(const sensor_msgs::msg::CompressedImage& color, const geometry::PinholeCamera& camera) {
  const auto size = images::encoded_size(color.data());
  if (!size) return Gray::refused("compressed colour image is neither JPEG nor PNG");
  const auto problem = size_problem("compressed colour", size->width, size->height, camera);
  if (!problem.empty()) return Gray::refused(problem);
  auto gray = images::decode_gray(color.data());
  if (!gray || gray->width != camera.width || gray->height != camera.height)
    return Gray::refused("compressed colour image is damaged");
  return std::move(*gray);
}

}  // namespace

messages::Converted<RgbdFrame> FrameConverter::convert(const ColorMessage& color, geometry::DepthImage depth,
                                                       const sensor_msgs::msg::CameraInfo& info, time::Time stamp) {
  using Result = messages::Converted<RgbdFrame>;
  const auto camera = messages::lens_camera(info);
  if (!camera) return Result::refused(std::string(topics::kColorInfo.name) + ": " + camera.reason);
  auto gray = std::visit([&](const auto& message) { return to_gray(message, camera->pinhole); }, color);
  if (!gray) return Result::refused(gray.reason);
  rectifier_.of(*camera).rectify(*gray);
  return RgbdFrame{stamp, camera->pinhole, std::move(*gray), std::move(depth)};
}

}  // namespace lapis::slam
