#include "common/images/depth_registration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapis::images {
namespace {

constexpr float kNearest_m = 0.01F;  // nothing nearer to the colour camera is taken over
// Pixels overlap by this much to either side [px]: on a slanted surface neighbours shift by unequal amounts.
constexpr float kOverlap_px = 0.15F;

/// The pixels whose centres are within `reach` of a position, cut off at the image's border.
struct Span {
  int first, end;
  Span(float position, float reach, int size)
      : first(std::max(0, static_cast<int>(std::ceil(position - reach)))),
        end(std::min(size, static_cast<int>(std::ceil(position + reach)))) {}
};

/// False for a position that no int holds.
bool is_near_image(float u, float v, const geometry::PinholeCamera& camera) {
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  return u > -width && u < 2.0F * width && v > -height && v < 2.0F * height;
}

}  // namespace

bool RgbdCalibration::is_registered() const {
  return color.pinhole == depth.pinhole && T_color_depth.matrix() == geometry::Pose::Identity().matrix();
}

bool RgbdCalibration::operator==(const RgbdCalibration& other) const {
  return color == other.color && depth == other.depth && T_color_depth.matrix() == other.T_color_depth.matrix();
}

DepthRegistration::DepthRegistration(const RgbdCalibration& calibration)
    : calibration_(calibration), rectifier_(calibration.depth) {
  const geometry::PinholeCamera &from = calibration.depth.pinhole, &to = calibration.color.pinhole;
  const Eigen::Matrix3d rotation = calibration.T_color_depth.linear();
  for (int u = 0; u < from.width; ++u) columns_.emplace_back(((u - from.cx) / from.fx * rotation.col(0)).cast<float>());
  for (int v = 0; v < from.height; ++v) {
    rows_.emplace_back(((v - from.cy) / from.fy * rotation.col(1) + rotation.col(2)).cast<float>());
  }
  reach_px_ = 0.5F * Eigen::Vector2d(to.fx / from.fx, to.fy / from.fy).cast<float>();
  reach_px_.array() += kOverlap_px;
}

geometry::DepthImage DepthRegistration::operator()(geometry::DepthImage depth) const {
  rectifier_.rectify(depth);
  if (calibration_.is_registered()) return depth;
  const geometry::PinholeCamera& camera = calibration_.color.pinhole;
  const Eigen::Vector3f shift = calibration_.T_color_depth.translation().cast<float>();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  constexpr float kNothing = std::numeric_limits<float>::infinity();
  geometry::DepthImage result(camera.width, camera.height, kNothing);
  const float* from = depth.pixels.data();
  for (const Eigen::Vector3f& row : rows_) {
    for (const Eigen::Vector3f& column : columns_) {
      const float distance_m = *from++;
      if (!(distance_m > 0.0F)) continue;
      const Eigen::Vector3f p = distance_m * (column + row) + shift;
      if (!(p.z() > kNearest_m)) continue;
      const float u = fx * p.x() / p.z() + cx, v = fy * p.y() / p.z() + cy;
      if (!is_near_image(u, v, camera)) continue;
      const Span columns(u, reach_px_.x(), camera.width), rows(v, reach_px_.y(), camera.height);
      for (int y = rows.first; y < rows.end; ++y) {
        for (int x = columns.first; x < columns.end; ++x) result(x, y) = std::min(result(x, y), p.z());
      }
    }
  }
  std::replace(result.pixels.begin(), result.pixels.end(), kNothing, 0.0F);
  return result;
}

}  // namespace lapis::images
