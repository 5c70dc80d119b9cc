#include "sensor_replay/core/rectifier.hpp"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace lapis::sensor_replay {
namespace {

template <class Pixel>
void remap(geometry::Image<Pixel>& image, int type, const cv::Mat& x, const cv::Mat& y, int interpolation) {
  const cv::Mat source(image.height, image.width, type, image.pixels.data());
  geometry::Image<Pixel> result(image.width, image.height);
  cv::Mat target(image.height, image.width, type, result.pixels.data());
  cv::remap(source, target, x, y, interpolation, cv::BORDER_CONSTANT);
  image = std::move(result);
}

}  // namespace

struct Rectifier::Maps {
  cv::Mat x;  // where each pixel of the rectified image lies in the recorded one
  cv::Mat y;
};

Rectifier::Rectifier(const CameraFile& file) {
  if (std::all_of(file.distortion.begin(), file.distortion.end(), [](double d) { return d == 0.0; })) return;
  const auto& c = file.camera;
  const cv::Matx33d intrinsics(c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0);
  Maps maps;
  cv::initUndistortRectifyMap(intrinsics, file.distortion, cv::noArray(), intrinsics, cv::Size(c.width, c.height),
                              CV_32FC1, maps.x, maps.y);
  maps_ = std::make_unique<const Maps>(std::move(maps));
}

Rectifier::~Rectifier() = default;

void Rectifier::rectify(geometry::ColorImage& image) const {
  if (maps_ != nullptr) remap(image, CV_8UC3, maps_->x, maps_->y, cv::INTER_LINEAR);
}

void Rectifier::rectify(geometry::Image<std::uint16_t>& image) const {
  if (maps_ != nullptr) remap(image, CV_16UC1, maps_->x, maps_->y, cv::INTER_NEAREST);
}

}  // namespace lapis::sensor_replay
