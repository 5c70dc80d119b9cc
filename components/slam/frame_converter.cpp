#include "slam/frame_converter.hpp"

#include "common/images/encoded_image.hpp"
#include "common/messages/camera.hpp"
#include "common/topics/camera.hpp"

namespace lapis::slam {
namespace {

using Gray = messages::Converted<geometry::GrayImage>;

/// Why an image does not have the camera's size; empty when it does.
std::string size_problem(const std::string& what, int width, int height, const geometry::PinholeCamera& camera) {
  if (width == camera.width && height == camera.height) return "";
  const auto text = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
  return what + " image is " + text(width, height) + ", camera info says " + text(camera.width, camera.height);
}

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

messages::Converted<RgbdFrame> FrameConverter::convert(const ColorMessage& color, const sensor_msgs::msg::Image& depth,
                                                       const sensor_msgs::msg::CameraInfo& info, time::Time stamp) {
  using Result = messages::Converted<RgbdFrame>;
  const auto camera = messages::lens_camera(info);
  if (!camera) return Result::refused(std::string(topics::kColorInfo.name) + ": " + camera.reason);
  auto metres = messages::to_depth(depth);
  if (!metres) return Result::refused(metres.reason);
  const auto problem = size_problem("depth", metres->width, metres->height, camera->pinhole);
  if (!problem.empty()) return Result::refused(problem);
  auto gray = std::visit([&](const auto& message) { return to_gray(message, camera->pinhole); }, color);
  if (!gray) return Result::refused(gray.reason);
  if (camera->is_distorted()) {
    rectifier(*camera).rectify(*gray);
    rectifier(*camera).rectify(*metres);
  }
  return RgbdFrame{stamp, camera->pinhole, std::move(*gray), std::move(*metres)};
}

/// Made once per calibration, because its tables take longer than a frame.
const images::Rectifier& FrameConverter::rectifier(const geometry::LensCamera& camera) {
  if (rectifier_ == nullptr || camera != camera_) {
    rectifier_ = std::make_unique<const images::Rectifier>(camera);
    camera_ = camera;
  }
  return *rectifier_;
}

}  // namespace lapis::slam
