#include "slam/core/surface.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "slam/core/noise_model.hpp"

namespace lapis::slam {
namespace {

constexpr int kNormalReach_px = 2;     // distance of the pixels whose differences give the normal
constexpr double kMinIncidence = 0.1;  // cosine between the normal and the viewing ray

// On a plane inverse depth is linear in the pixel: the centre equals the mean of opposite neighbours.
bool is_smooth(const NoiseConfig& noise, double a, double centre, double b) {
  if (!is_depth(noise, a) || !is_depth(noise, b)) return false;
  const double expected = 2.0 / (1.0 / a + 1.0 / b);
  return std::abs(expected - centre) < 3.0 * depth_sigma(noise, centre);
}

std::optional<SurfaceSample> sample_at(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                                       const geometry::DepthImage& depth, int x, int y) {
  constexpr int r = kNormalReach_px;
  const double centre = depth(x, y);
  if (!is_depth(noise, centre)) return std::nullopt;
  const double left = depth(x - r, y), right = depth(x + r, y), up = depth(x, y - r), down = depth(x, y + r);
  if (!is_smooth(noise, left, centre, right) || !is_smooth(noise, up, centre, down)) return std::nullopt;
  const Eigen::Vector3d across = camera.unproject(x + r, y, right) - camera.unproject(x - r, y, left);
  const Eigen::Vector3d along = camera.unproject(x, y + r, down) - camera.unproject(x, y - r, up);
  SurfaceSample sample;
  sample.point = camera.unproject(x, y, centre);
  sample.normal = along.cross(across).normalized();
  if (-sample.normal.dot(sample.point.normalized()) < kMinIncidence) return std::nullopt;
  return sample;
}

}  // namespace

std::vector<SurfaceSample> sample_surface(const SurfaceConfig& config, const NoiseConfig& noise,
                                          const geometry::PinholeCamera& camera, const geometry::DepthImage& depth) {
  std::vector<SurfaceSample> samples;
  const int first = std::max(config.grid_step_px / 2, kNormalReach_px);
  for (int y = first; y < depth.height - kNormalReach_px; y += config.grid_step_px) {
    for (int x = first; x < depth.width - kNormalReach_px; x += config.grid_step_px) {
      if (const auto sample = sample_at(noise, camera, depth, x, y)) samples.push_back(*sample);
    }
  }
  return samples;
}

}  // namespace lapis::slam
