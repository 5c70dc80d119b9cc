#include "simulator/core/noise/depth_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "simulator/core/noise/normal_table.hpp"
#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {
namespace {

using geometry::DepthImage;

constexpr float kMaxEncodable_m = 65.5F;  // 65535 mm

std::uint16_t millimetres(float depth_m) { return static_cast<std::uint16_t>(depth_m * 1000.0F + 0.5F); }

geometry::Image<std::uint16_t> ideal_millimetres(const DepthImage& ideal) {
  geometry::Image<std::uint16_t> result(ideal.width, ideal.height);
  for (std::size_t i = 0; i < ideal.pixels.size(); ++i) {
    const float z = ideal.pixels[i];
    if (z > 0.0F && z < kMaxEncodable_m) result.pixels[i] = millimetres(z);
  }
  return result;
}

/// Nearest integer, for |x| < 1000.
int rounded(float x) { return static_cast<int>(x + 1000.5F) - 1000; }

/// One pixel, and the random bits of this frame for it.
struct PixelDraw {
  int column, row;
  float cosine;
  std::uint64_t bits;
};

/// Ideal depth at a normally distributed offset; slots 0 and 1 of the bits.
float jittered(const DepthImage& ideal, const PixelDraw& pixel, float sigma_px, int& column, int& row) {
  const NormalTable& normal = NormalTable::get();
  column = std::clamp(pixel.column + rounded(sigma_px * normal(pixel.bits, 0)), 0, ideal.width - 1);
  row = std::clamp(pixel.row + rounded(sigma_px * normal(pixel.bits, 1)), 0, ideal.height - 1);
  return ideal(column, row);
}

/// The factors of the Kinect model that depend on the angle of incidence.
struct AngleFactors {
  float lateral_px;  ///< standard deviation across the ray
  float grazing;     ///< of what 1/sqrt(z) is multiplied with
};
constexpr int kAngleBins = 1024;  // of the cosine

std::array<AngleFactors, kAngleBins> compute_angle_factors() {
  std::array<AngleFactors, kAngleBins> factors;
  for (int i = 0; i < kAngleBins; ++i) {
    const double theta = std::acos((i + 0.5) / kAngleBins);
    const double ratio = theta / (std::numbers::pi / 2 - theta);
    const bool is_grazing = theta > std::numbers::pi / 3;
    factors[static_cast<std::size_t>(i)] = {static_cast<float>(0.8 + 0.035 * ratio),
                                            is_grazing ? static_cast<float>(0.0001 * ratio * ratio) : 0.0F};
  }
  return factors;
}

/// Nguyen et al. 2012: lateral noise as jitter of the ray, axial noise, and its grazing term beyond 60 degrees.
class Kinect {
 public:
  explicit Kinect(double multiplier) : multiplier_(static_cast<float>(multiplier)) {}
  float operator()(const DepthImage& ideal, const PixelDraw& pixel) const {
    const AngleFactors& factors = factors_[static_cast<std::size_t>(std::min(
        static_cast<int>(std::min(pixel.cosine, 1.0F) * kAngleBins), kAngleBins - 1))];
    int column = 0, row = 0;
    const float z = jittered(ideal, pixel, multiplier_ * factors.lateral_px, column, row);
    float sigma_m = 0.0012F + 0.0019F * (z - 0.4F) * (z - 0.4F);
    if (factors.grazing > 0.0F) sigma_m += factors.grazing / std::sqrt(z);
    return z > 0.0F ? z + multiplier_ * sigma_m * NormalTable::get()(pixel.bits, 2) : 0.0F;
  }

 private:
  static const std::array<AngleFactors, kAngleBins> factors_;
  float multiplier_;
};
const std::array<AngleFactors, kAngleBins> Kinect::factors_ = compute_angle_factors();
