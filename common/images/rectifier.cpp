#include "common/images/rectifier.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace lapis::images {
namespace {

template <class Pixel>
void remap(geometry::Image<Pixel>& image, int type, const cv::Mat& whole, const cv::Mat& parts, int interpolation) {
  const cv::Mat source(image.height, image.width, type, image.pixels.data());
  geometry::Image<Pixel> result(image.width, image.height);
  cv::Mat target(image.height, image.width, type, result.pixels.data());
  cv::remap(source, target, whole, parts, interpolation, cv::BORDER_CONSTANT);
  image = std::move(result);
}

}  // namespace

// Position in the recorded image of each pixel of the rectified image [px].
struct Rectifier::Maps {
  cv::Mat whole;    // rounded down
  cv::Mat parts;    // the remainder of `whole` in units of 1/32 px
  cv::Mat nearest;  // rounded
};

Rectifier::Rectifier(const geometry::LensCamera& camera) {
  if (!camera.is_distorted()) return;
  const auto& c = camera.pinhole;
  const cv::Matx33d intrinsics(c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0);
  cv::Mat x;
  cv::Mat y;
  cv::initUndistortRectifyMap(intrinsics, camera.distortion, cv::noArray(), intrinsics, cv::Size(c.width, c.height),
                              CV_32FC1, x, y);
  // The maps are computed as floats and converted here, so that positions far outside the image do not wrap around.
  Maps maps;
  cv::convertMaps(x, y, maps.whole, maps.parts, CV_16SC2);
  cv::Mat none;
  cv::convertMaps(x, y, maps.nearest, none, CV_16SC2, true);
  maps_ = std::make_unique<const Maps>(std::move(maps));
}

Rectifier::~Rectifier() = default;

void Rectifier::rectify(geometry::ColorImage& image) const {
  if (maps_ != nullptr) remap(image, CV_8UC3, maps_->whole, maps_->parts, cv::INTER_LINEAR);
}

void Rectifier::rectify(geometry::GrayImage& image) const {
  if (maps_ != nullptr) remap(image, CV_8UC1, maps_->whole, maps_->parts, cv::INTER_LINEAR);
}

void Rectifier::rectify(geometry::DepthImage& image) const {
  if (maps_ != nullptr) remap(image, CV_32FC1, maps_->nearest, cv::Mat(), cv::INTER_NEAREST);
}

void Rectifier::rectify(geometry::Image<std::uint16_t>& image) const {
  if (maps_ != nullptr) remap(image, CV_16UC1, maps_->nearest, cv::Mat(), cv::INTER_NEAREST);
}

const Rectifier& KeptRectifier::of(const geometry::LensCamera& camera) {
  if (rectifier_ == nullptr || camera != camera_) {
    rectifier_ = std::make_unique<const Rectifier>(camera);
    camera_ = camera;
  }
  return *rectifier_;
}

}  // namespace lapis::images
