#include "slam/core/frame/surface.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "slam/core/frame/noise_model.hpp"

namespace lapis::slam {
namespace {

constexpr double kMinIncidence = 0.1;  // cosine between the normal and the viewing ray
constexpr double kLeastShare = 0.6;    // least share of a cell's pixels that have depth
// Largest difference of a cell (RMS), and of each of its rows and columns (mean), from the cell's plane, in sigmas of
// the depth noise. A plane through a step takes up most of it, but leaves the lines beside the step far off.
constexpr double kMostSigmas = 1.5;

// Sums for the plane through a cell of the depth image, by least squares: on a plane, inverse depth is linear in the
// pixel, and its noise is the same all over a cell. All pixels of a cell are needed: from some metres on, the
// difference of two depths a few pixels apart is noise, and so is a normal from it.
struct CellSums {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, w = 0.0, xw = 0.0, yw = 0.0, ww = 0.0;

  void add(double column, double row, double inverse_depth) {
    n += 1.0;
    x += column;
    y += row;
    xx += column * column;
    xy += column * row;
    yy += row * row;
    w += inverse_depth;
    xw += column * inverse_depth;
    yw += row * inverse_depth;
    ww += inverse_depth * inverse_depth;
  }
};

// Whether the mean difference of a row or column from the plane exceeds `most` [1/m]. `plane`: slopes of the inverse
// depth by column and row, and its value in the middle.
bool has_step(const NoiseConfig& noise, const geometry::DepthImage& depth, int left, int top, int size,
              const Eigen::Vector3d& plane, double most) {
  struct Line {
    double sum = 0.0;
    int count = 0;
  };
  const double middle = 0.5 * (size - 1);
  std::vector<Line> lines(2 * static_cast<std::size_t>(size));
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const double z = depth(left + column, top + row);
      if (!is_depth(noise, z)) continue;
      const double difference = 1.0 / z - plane.dot(Eigen::Vector3d(column - middle, row - middle, 1.0));
      for (const int line : {column, size + row}) {
        lines[static_cast<std::size_t>(line)].sum += difference;
        ++lines[static_cast<std::size_t>(line)].count;
      }
    }
  }
  return std::any_of(lines.begin(), lines.end(), [&](const Line& line) {
    return 2 * line.count >= size && std::abs(line.sum) > most * line.count;
  });
}

std::optional<SurfaceSample> sample_cell(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                                         const geometry::DepthImage& depth, int left, int top, int size) {
  const double middle = 0.5 * (size - 1);
  CellSums sums;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const double z = depth(left + column, top + row);
      if (is_depth(noise, z)) sums.add(column - middle, row - middle, 1.0 / z);
    }
  }
  if (sums.n <= 3.0 || sums.n < kLeastShare * size * size) return std::nullopt;
  Eigen::Matrix3d normal_equations;
  normal_equations << sums.xx, sums.xy, sums.x, sums.xy, sums.yy, sums.y, sums.x, sums.y, sums.n;
  const Eigen::Vector3d right(sums.xw, sums.yw, sums.w);
  const Eigen::Vector3d plane = normal_equations.ldlt().solve(right);  // slopes, and inverse depth in the middle
  const double z = 1.0 / plane.z();
  if (!is_depth(noise, z)) return std::nullopt;
  const double variance = std::max(0.0, sums.ww - plane.dot(right)) / (sums.n - 3.0);
  const double most = kMostSigmas * depth_sigma(noise, z) / (z * z);
  if (!(std::sqrt(variance) <= most) || has_step(noise, depth, left, top, size, plane, most)) return std::nullopt;
  const double u = left + middle, v = top + middle;
  SurfaceSample sample;
  sample.point = camera.unproject(u, v, z);
  sample.normal = -Eigen::Vector3d(plane.x() * camera.fx, plane.y() * camera.fy,
                                   plane.z() - plane.x() * (u - camera.cx) - plane.y() * (v - camera.cy))
                       .normalized();
  if (-sample.normal.dot(sample.point.normalized()) < kMinIncidence) return std::nullopt;
  return sample;
}

}  // namespace

std::vector<SurfaceSample> sample_surface(const SurfaceConfig& config, const NoiseConfig& noise,
                                          const geometry::PinholeCamera& camera, const geometry::DepthImage& depth) {
  std::vector<SurfaceSample> samples;
  const int size = config.grid_step_px;
  for (int top = 0; top + size <= depth.height; top += size) {
    for (int left = 0; left + size <= depth.width; left += size) {
      if (const auto sample = sample_cell(noise, camera, depth, left, top, size)) samples.push_back(*sample);
    }
  }
  return samples;
}

}  // namespace lapis::slam
