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

/// 1 / depth [1/m], which on a plane is linear in the pixel; 0: none.
class DepthRegistration::InverseDepth {
 public:
  explicit InverseDepth(const geometry::DepthImage& depth) : image_(depth) {
    for (float& z : image_.pixels) z = z > 0.0F ? 1.0F / z : 0.0F;
  }
  /// Slope of the surface by those neighbours of a pixel that belong to it [1/m per px]; 0 where none does.
  float slope_right(int u, int v) const {
    return slope(u > 0 ? image_(u - 1, v) : 0.0F, image_(u, v), u + 1 < image_.width ? image_(u + 1, v) : 0.0F);
  }
  float slope_down(int u, int v) const {
    return slope(v > 0 ? image_(u, v - 1) : 0.0F, image_(u, v), v + 1 < image_.height ? image_(u, v + 1) : 0.0F);
  }

 private:
  static float slope(float before, float here, float after) {
    constexpr float kMostStep = 0.05F;  // of one surface
    const float most = kMostStep * here, back = here - before, ahead = after - here;
    const bool has_before = std::abs(back) < most, has_after = std::abs(ahead) < most;
    if (has_before && has_after) return 0.5F * (back + ahead);
    if (has_before) return back;
    return has_after ? ahead : 0.0F;
  }

  geometry::DepthImage image_;
};

bool RgbdCalibration::is_registered() const {
  return color.pinhole == depth.pinhole && T_color_depth.matrix() == geometry::Pose::Identity().matrix();
}

bool RgbdCalibration::operator==(const RgbdCalibration& other) const {
  return color == other.color && depth == other.depth && T_color_depth.matrix() == other.T_color_depth.matrix();
}

DepthRegistration::DepthRegistration(const RgbdCalibration& calibration)
    : calibration_(calibration), rectifier_(calibration.depth),
      shift_(calibration.T_color_depth.translation().cast<float>()),
      focal_px_(Eigen::Vector2d(calibration.color.pinhole.fx, calibration.color.pinhole.fy).cast<float>()),
      centre_px_(Eigen::Vector2d(calibration.color.pinhole.cx, calibration.color.pinhole.cy).cast<float>()),
      reach_px_(Eigen::Vector2f::Constant(kOverlap_px)) {
  const geometry::PinholeCamera &from = calibration.depth.pinhole, &to = calibration.color.pinhole;
  const Eigen::Matrix3d rotation = calibration.T_color_depth.linear();
  for (int u = 0; u < from.width; ++u) columns_.emplace_back(((u - from.cx) / from.fx * rotation.col(0)).cast<float>());
  for (int v = 0; v < from.height; ++v) {
    rows_.emplace_back(((v - from.cy) / from.fy * rotation.col(1) + rotation.col(2)).cast<float>());
  }
  pixels_per_px_ = Eigen::Vector2d(from.fx / to.fx, from.fy / to.fy).cast<float>();
  reach_px_ += 0.5F * pixels_per_px_.cwiseInverse();
}

geometry::DepthImage DepthRegistration::operator()(geometry::DepthImage depth) const {
  rectifier_.rectify(depth);
  if (calibration_.is_registered()) return depth;
  constexpr float kLeast = std::numeric_limits<float>::min();  // that has a finite inverse
  const InverseDepth inverse(depth);
  geometry::DepthImage result(calibration_.color.pinhole.width, calibration_.color.pinhole.height);
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      if (depth(u, v) > 0.0F) draw(depth(u, v), inverse, u, v, result);
    }
  }
  for (float& z : result.pixels) z = z > kLeast ? 1.0F / z : 0.0F;
  return result;
}

void DepthRegistration::draw(float depth_m, const InverseDepth& inverse, int column, int row,
                             geometry::DepthImage& result) const {
  const geometry::PinholeCamera& camera = calibration_.color.pinhole;
  const Eigen::Vector3f p =
      depth_m * (columns_[static_cast<std::size_t>(column)] + rows_[static_cast<std::size_t>(row)]) + shift_;
  if (!(p.z() > kNearest_m)) return;
  const float nearness = 1.0F / p.z();
  const float u = focal_px_.x() * p.x() * nearness + centre_px_.x(),
              v = focal_px_.y() * p.y() * nearness + centre_px_.y();
  if (!is_near_image(u, v, camera)) return;
  const float right = inverse.slope_right(column, row) * pixels_per_px_.x();
  const float down = inverse.slope_down(column, row) * pixels_per_px_.y();
  const Span columns(u, reach_px_.x(), camera.width), rows(v, reach_px_.y(), camera.height);
  for (int y = rows.first; y < rows.end; ++y) {
    for (int x = columns.first; x < columns.end; ++x) {
      const float here = nearness + right * (static_cast<float>(x) - u) + down * (static_cast<float>(y) - v);
      result(x, y) = std::max(result(x, y), here);
    }
  }
}

}  // namespace lapis::images
