#include "simulator/core/noise/depth_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "simulator/core/noise/normal_table.hpp"
#include "simulator/core/noise/random.hpp"
#include "simulator/core/noise/rounded.hpp"

namespace lapis::simulator {
namespace {

using geometry::DepthImage;

constexpr float kMaxEncodable_m = 65.5F;  // 65535 mm

std::uint16_t millimetres(float depth_m) { return static_cast<std::uint16_t>(rounded(depth_m * 1000.0F)); }

geometry::Image<std::uint16_t> ideal_millimetres(const DepthImage& ideal) {
  geometry::Image<std::uint16_t> result(ideal.width, ideal.height);
  for (std::size_t i = 0; i < ideal.pixels.size(); ++i) {
    const float z = ideal.pixels[i];
    if (z > 0.0F && z < kMaxEncodable_m) result.pixels[i] = millimetres(z);
  }
  return result;
}

/// One pixel, and the random bits of this frame for it.
struct PixelDraw {
  int column, row;
  float cosine;
  std::uint64_t bits;
};

/// The pixel to which the ray of a pixel goes when it is jittered, by slots 0 and 1 of the bits.
struct Source {
  int column, row;
};
Source jittered(const DepthImage& ideal, const PixelDraw& pixel, const NormalTable& normal, float sigma_px) {
  return {std::clamp(pixel.column + rounded(sigma_px * normal(pixel.bits, 0)), 0, ideal.width - 1),
          std::clamp(pixel.row + rounded(sigma_px * normal(pixel.bits, 1)), 0, ideal.height - 1)};
}

/// The parts of the Kinect model that depend on the angle of incidence, by its cosine.
class AngleTable {
 public:
  struct Factors {
    float lateral_px;  ///< standard deviation across the ray
    float grazing;     ///< 1 / sqrt(z) times this is added to the axial standard deviation
  };
  static const AngleTable& get() {
    static const AngleTable table;
    return table;
  }
  const Factors& operator()(float cosine) const {
    const int bin = static_cast<int>(std::min(cosine, 1.0F) * static_cast<float>(kBins));
    return factors_[static_cast<std::size_t>(std::min(bin, kBins - 1))];
  }

 private:
  static constexpr int kBins = 1024;

  AngleTable() {
    for (int i = 0; i < kBins; ++i) {
      const double theta = std::acos((i + 0.5) / kBins);
      const double ratio = theta / (std::numbers::pi / 2 - theta);
      const double grazing = theta > std::numbers::pi / 3 ? 0.0001 * ratio * ratio : 0.0;
      factors_[static_cast<std::size_t>(i)] = {static_cast<float>(0.8 + 0.035 * ratio), static_cast<float>(grazing)};
    }
  }
  std::array<Factors, kBins> factors_;
};

/// Nguyen et al. 2012: lateral noise as jitter of the ray, axial noise, and its grazing term beyond 60 degrees.
struct Kinect {
  float multiplier;
  const NormalTable& normal = NormalTable::get();
  const AngleTable& angles = AngleTable::get();

  float operator()(const DepthImage& ideal, const PixelDraw& pixel) const {
    const AngleTable::Factors& factors = angles(pixel.cosine);
    const Source source = jittered(ideal, pixel, normal, multiplier * factors.lateral_px);
    const float z = ideal(source.column, source.row);
    if (!(z > 0.0F)) return 0.0F;
    float sigma_m = 0.0012F + 0.0019F * (z - 0.4F) * (z - 0.4F);
    if (factors.grazing > 0.0F) sigma_m += factors.grazing / std::sqrt(z);
    return z + multiplier * sigma_m * normal(pixel.bits, 2);
  }
};

/// The simulated Kinect of Redwood: jittered depth of every second pixel; disparity with noise, in steps of 1/8.
struct Redwood {
  float multiplier;
  const NormalTable& normal = NormalTable::get();

  float operator()(const DepthImage& ideal, const PixelDraw& pixel) const {
    constexpr float kDisparityAtOneMetre = 35.130F, kSteps = 8.0F, kTooFar_m = 10.0F;
    const Source source = jittered(ideal, pixel, normal, multiplier * 0.25F);
    const float z = ideal(source.column - source.column % 2, source.row - source.row % 2);
    if (!(z > 0.0F)) return 0.0F;
    const float disparity = kDisparityAtOneMetre / z + multiplier * 0.027778F * normal(pixel.bits, 2);
    const float measured = kDisparityAtOneMetre * kSteps / static_cast<float>(rounded(disparity * kSteps));
    return measured < kTooFar_m ? measured : 0.0F;
  }
};

/// Stereo: sigma_z = sigma_disparity z^2 / (f b).
struct Realsense {
  float sigma_per_z2;
  const NormalTable& normal = NormalTable::get();

  float operator()(const DepthImage& ideal, const PixelDraw& pixel) const {
    const float z = ideal(pixel.column, pixel.row);
    return z + sigma_per_z2 * z * z * normal(pixel.bits, 2);
  }
};

/// Marks the pixels of a row whose depth differs from a neighbour's by more than the share `slope` of their own.
void find_edges(const DepthImage& ideal, int row, float slope, std::vector<std::uint8_t>& is_edge) {
  const float* here = &ideal(0, row);
  const float* above = &ideal(0, std::max(row - 1, 0));
  const float* below = &ideal(0, std::min(row + 1, ideal.height - 1));
  const auto width = static_cast<std::size_t>(ideal.width);
  for (std::size_t i = 0; i < width; ++i) {
    const float limit = slope * here[i];
    const float left = here[i == 0 ? i : i - 1], right = here[i + 1 == width ? i : i + 1];
    const float vertical = std::max(std::abs(here[i] - above[i]), std::abs(here[i] - below[i]));
    const float horizontal = std::max(std::abs(here[i] - left), std::abs(here[i] - right));
    is_edge[i] = static_cast<std::uint8_t>(std::max(vertical, horizontal) > limit);
  }
}

/// A pixel drops out when 16 random bits are less than this.
std::uint32_t threshold(double share) {
  return static_cast<std::uint32_t>(std::lround(std::clamp(share, 0.0, 1.0) * 65536.0));
}

template <class Model>
geometry::Image<std::uint16_t> measure(const DepthImage& ideal, const geometry::Image<float>& cosines,
                                       const DepthNoiseConfig& config, const Random& random, const Model& model) {
  geometry::Image<std::uint16_t> result(ideal.width, ideal.height);
  const auto low = static_cast<float>(config.min_range_m);
  const auto high = std::min(static_cast<float>(config.max_range_m), kMaxEncodable_m);
  const auto min_cosine = static_cast<float>(std::cos(config.max_angle_rad));
  const double extra = config.extra_dropout, edge = config.edge_dropout;
  const std::array<std::uint32_t, 2> dropout{threshold(extra), threshold(extra + edge - extra * edge)};
  std::vector<std::uint8_t> is_edge(static_cast<std::size_t>(ideal.width));
  std::size_t i = 0;
  for (int row = 0; row < ideal.height; ++row) {
    find_edges(ideal, row, static_cast<float>(config.edge_slope), is_edge);
    for (int column = 0; column < ideal.width; ++column, ++i) {
      const float z = ideal.pixels[i], cosine = cosines.pixels[i];
      if (!(z >= low && z <= high && cosine >= min_cosine)) continue;
      const std::uint64_t bits = random.bits(i);
      if ((bits >> 48U) < dropout[is_edge[static_cast<std::size_t>(column)]]) continue;
      const float measured = model(ideal, PixelDraw{column, row, cosine, bits});
      if (measured >= low && measured <= high) result.pixels[i] = millimetres(measured);
    }
  }
  return result;
}

}  // namespace

geometry::Image<std::uint16_t> DepthNoise::apply(const DepthImage& ideal, const geometry::Image<float>& cosines,
                                                 double focal_px, std::uint64_t tick) const {
  if (config_.model == DepthModel::kNone) return ideal_millimetres(ideal);
  if (cosines.width != ideal.width || cosines.height != ideal.height)
    throw std::invalid_argument("depth noise: depth and cosines must have one image size");
  constexpr double kDisparitySigma_px = 0.08, kBase_m = 0.05;
  const Random random(seed_, RandomStream::kDepth, tick);
  const auto multiplier = static_cast<float>(config_.noise_multiplier);
  switch (config_.model) {
    case DepthModel::kKinect: return measure(ideal, cosines, config_, random, Kinect{multiplier});
    case DepthModel::kRedwood: return measure(ideal, cosines, config_, random, Redwood{multiplier});
    default: break;
  }
  const double per_z2 = config_.noise_multiplier * kDisparitySigma_px / (focal_px * kBase_m);
  return measure(ideal, cosines, config_, random, Realsense{static_cast<float>(per_z2)});
}

}  // namespace lapis::simulator
