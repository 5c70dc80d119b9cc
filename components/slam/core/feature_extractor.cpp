#include "slam/core/feature_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace lapis::slam {
namespace {

constexpr int kPatchRadius = 15;
constexpr int kBorder = kFeatureBorder_px;

struct Level {
  cv::Mat image;
  double scale = 1.0;    // nominal, as cv::ORB computes it
  double ratio_x = 1.0;  // size of a level pixel in pixels of the full image: the level's size is rounded
  double ratio_y = 1.0;
};

// Half widths of the rows of a disc, for the intensity centroid.
std::array<int, kPatchRadius + 1> disc_half_widths() {
  std::array<int, kPatchRadius + 1> half{};
  for (int row = 0; row <= kPatchRadius; ++row) {
    half[static_cast<std::size_t>(row)] =
        static_cast<int>(std::lround(std::sqrt(kPatchRadius * kPatchRadius - row * row)));
  }
  return half;
}

// Direction [degrees] from a corner to the intensity centroid of the disc around it. Eq. 1-3 in [Rublee 2011]
float corner_angle(const cv::Mat& image, int x, int y) {
  static const auto kHalf = disc_half_widths();
  int moment_x = 0;
  int moment_y = 0;
  for (int row = -kPatchRadius; row <= kPatchRadius; ++row) {
    const int half = kHalf[static_cast<std::size_t>(std::abs(row))];
    const std::uint8_t* pixels = image.ptr<std::uint8_t>(y + row) + x;
    int sum = 0;
    for (int column = -half; column <= half; ++column) {
      moment_x += column * pixels[column];
      sum += pixels[column];
    }
    moment_y += row * sum;
  }
  return cv::fastAtan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

std::vector<Corner> detect_corners(const cv::Mat& image, int threshold) {
  if (image.cols <= 2 * kBorder || image.rows <= 2 * kBorder) return {};
  const cv::Rect inside(kBorder - 3, kBorder - 3, image.cols - 2 * kBorder + 6, image.rows - 2 * kBorder + 6);
  std::vector<cv::KeyPoint> found;
  cv::FAST(image(inside), found, threshold, true);
  std::vector<Corner> corners;
  corners.reserve(found.size());
  for (const auto& point : found) {
    corners.push_back(
        {static_cast<int>(point.pt.x) + inside.x, static_cast<int>(point.pt.y) + inside.y, point.response});
  }
  return corners;
}

}  // namespace

std::vector<Corner> spread_corners(std::vector<Corner> corners, int width, int height, int count) {
  if (count <= 0 || corners.empty()) return {};
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::tuple(-a.score, a.y, a.x) < std::tuple(-b.score, b.y, b.x);
  });
  const double cell = std::max(1.0, std::sqrt(static_cast<double>(width) * height / count));
  const auto columns = static_cast<std::size_t>(width / cell) + 1;
  const auto rows = static_cast<std::size_t>(height / cell) + 1;
  std::vector<std::size_t> taken(columns * rows, 0);
  std::vector<std::vector<Corner>> ranks;  // the best of every cell, the second best, ...
  for (const Corner& corner : corners) {
    const std::size_t rank =
        taken[static_cast<std::size_t>(corner.y / cell) * columns + static_cast<std::size_t>(corner.x / cell)]++;
    if (rank == ranks.size()) ranks.emplace_back();
    ranks[rank].push_back(corner);
  }
  std::vector<Corner> chosen;
  for (const std::vector<Corner>& rank : ranks) {
    const std::size_t room = static_cast<std::size_t>(count) - chosen.size();
    chosen.insert(chosen.end(), rank.begin(), rank.begin() + static_cast<std::ptrdiff_t>(std::min(room, rank.size())));
  }
  return chosen;
}

struct FeatureExtractor::Implementation {
  FeatureConfig config;
  cv::Ptr<cv::ORB> orb;

  std::vector<Level> build_pyramid(const cv::Mat& image) const {
    std::vector<Level> levels{{image, 1.0, 1.0, 1.0}};
    for (int i = 1; i < config.levels; ++i) {
      const double scale = std::pow(config.scale_factor, i);
      const cv::Size size(cvRound(image.cols / scale), cvRound(image.rows / scale));
      if (size.width <= 2 * kBorder || size.height <= 2 * kBorder) break;
      Level level{
          {}, scale, static_cast<double>(image.cols) / size.width, static_cast<double>(image.rows) / size.height};
      cv::resize(levels.back().image, level.image, size, 0, 0, cv::INTER_LINEAR_EXACT);
      levels.push_back(level);
    }
    return levels;
  }

  // Key-points as cv::ORB wants them: level coordinates times scale. Levels share the budget by area.
  std::vector<cv::KeyPoint> detect(const std::vector<Level>& levels) const {
    double area = 0.0;
    for (const Level& level : levels) area += 1.0 / (level.scale * level.scale);
    std::vector<cv::KeyPoint> points;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const cv::Mat& image = levels[i].image;
      const double scale = levels[i].scale;
      const int count = static_cast<int>(std::lround(config.max_features / (scale * scale * area)));
      for (const Corner& corner :
           spread_corners(detect_corners(image, config.fast_threshold), image.cols, image.rows, count)) {
        points.emplace_back(static_cast<float>(corner.x * scale), static_cast<float>(corner.y * scale),
                            static_cast<float>((2 * kPatchRadius + 1) * scale), corner_angle(image, corner.x, corner.y),
                            corner.score, static_cast<int>(i));
      }
    }
    return points;
  }
};

FeatureExtractor::FeatureExtractor(const FeatureConfig& config) : implementation_(new Implementation{config, {}}) {
  implementation_->orb =
      cv::ORB::create(config.max_features, static_cast<float>(config.scale_factor), config.levels, kPatchRadius + 1, 0,
                      2, cv::ORB::HARRIS_SCORE, 2 * kPatchRadius + 1, config.fast_threshold);
}

FeatureExtractor::~FeatureExtractor() = default;

std::vector<Feature> FeatureExtractor::extract(const geometry::GrayImage& image) const {
  if (image.width <= 2 * kBorder || image.height <= 2 * kBorder) return {};
  const cv::Mat view(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
  const std::vector<Level> levels = implementation_->build_pyramid(view);
  std::vector<cv::KeyPoint> points = implementation_->detect(levels);
  if (points.empty()) return {};
  cv::Mat descriptors;
  implementation_->orb->compute(view, points, descriptors);

  std::vector<Feature> features(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Level& level = levels[static_cast<std::size_t>(points[i].octave)];
    // cv::resize aligns the borders of the images, and the level's size is rounded.
    features[i].pixel = {(points[i].pt.x / level.scale + 0.5) * level.ratio_x - 0.5,
                         (points[i].pt.y / level.scale + 0.5) * level.ratio_y - 0.5};
    features[i].octave = points[i].octave;
    std::memcpy(features[i].descriptor.data(), descriptors.ptr(static_cast<int>(i)), sizeof(Descriptor));
  }
  return features;
}

}  // namespace lapis::slam
