#include "slam/core/frame/feature_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/core/frame/pixel_noise.hpp"

namespace lapis::slam {
namespace {

constexpr int kPatchRadius = 15;
constexpr int kBorder = 19;  // distance of features from the level's edge: the descriptor reads a rotated 31 px patch

struct Level {
  cv::Mat image;
  double scale = 1.0;    // nominal
  double ratio_x = 1.0;  // size of a level pixel in pixels of the full image: the level's size is rounded
  double ratio_y = 1.0;
};

// Column and row of each pixel of a disc relative to its centre; 0 outside of the disc. A row has 32 pixels, 15 of them
// left of the centre, so that compilers can use whole registers.
constexpr int kPatchWidth = 2 * kPatchRadius + 2;
struct Disc {
  std::array<std::array<std::int16_t, kPatchWidth>, 2 * kPatchRadius + 1> column{}, row{};

  Disc() {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const int y = static_cast<int>(i) - kPatchRadius;
      const auto half = std::lround(std::sqrt(kPatchRadius * kPatchRadius - y * y));
      for (std::size_t j = 0; j < kPatchWidth; ++j) {
        const int x = static_cast<int>(j) - kPatchRadius;
        if (std::abs(x) > half) continue;
        column[i][j] = static_cast<std::int16_t>(x);
        row[i][j] = static_cast<std::int16_t>(y);
      }
    }
  }
};

// Direction [degrees] from a corner to the intensity centroid of the disc around it. Eq. 1-3 in [Rublee 2011].
float corner_angle(const cv::Mat& image, int x, int y) {
  static const Disc kDisc;
  int moment_x = 0;
  int moment_y = 0;
  for (std::size_t i = 0; i < kDisc.row.size(); ++i) {
    const std::uint8_t* pixels = image.ptr<std::uint8_t>(y - kPatchRadius + static_cast<int>(i)) + x - kPatchRadius;
    for (std::size_t j = 0; j < kPatchWidth; ++j) {
      const std::int16_t pixel = pixels[j];
      moment_x += kDisc.column[i][j] * pixel;
      moment_y += kDisc.row[i][j] * pixel;
    }
  }
  return cv::fastAtan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

bool is_better(const Corner& a, const Corner& b) {
  return std::tuple(-a.score, a.y, a.x) < std::tuple(-b.score, b.y, b.x);
}

// Whether the image determines the position of a corner in both directions, by the eigenvalues of the structure tensor
// of its neighbourhood [Harris 1988]. A corner that noise makes on a straight edge slides along the edge when the
// camera moves.
bool is_fixed(const cv::Mat& image, int x, int y, double least_share) {
  constexpr int kRadius = 3;
  if (least_share <= 0.0) return true;
  int xx = 0, xy = 0, yy = 0;
  for (int v = y - kRadius; v <= y + kRadius; ++v) {
    const auto* above = image.ptr<std::uint8_t>(v - 1);
    const auto* row = image.ptr<std::uint8_t>(v);
    const auto* below = image.ptr<std::uint8_t>(v + 1);
    for (int u = x - kRadius; u <= x + kRadius; ++u) {
      const int dx = row[u + 1] - row[u - 1], dy = below[u] - above[u];
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  const double mean = 0.5 * (xx + yy), apart = std::hypot(0.5 * (xx - yy), xy);
  return mean - apart >= least_share * (mean + apart);
}

std::vector<Corner> detect_corners(const cv::Mat& image, int threshold, double least_share) {
  const cv::Rect inside(kBorder - 3, kBorder - 3, image.cols - 2 * kBorder + 6, image.rows - 2 * kBorder + 6);
  std::vector<cv::KeyPoint> found;
  cv::FAST(image(inside), found, threshold, true);
  std::vector<Corner> corners;
  corners.reserve(found.size());
  for (const auto& point : found) {
    const int x = static_cast<int>(point.pt.x) + inside.x, y = static_cast<int>(point.pt.y) + inside.y;
    if (is_fixed(image, x, y, least_share)) corners.push_back({x, y, point.response});
  }
  return corners;
}

// Contrast [grey levels] that noise alone hardly has: three standard deviations of the difference of two pixels.
int least_contrast(const cv::Mat& image) {
  const double noise = pixel_noise({image.data, image.cols, image.rows, image.step});
  return static_cast<int>(std::ceil(3.0 * std::sqrt(2.0) * noise));
}

// Corners of a level. In dark, flat and washed-out images they have little contrast: where there is less than a third
// of what is wanted, all that stand out from the noise are taken. With a third tracking is safe (0074), and corners of
// little contrast are worse than others.
std::vector<Corner> find_corners(const cv::Mat& image, const FeatureConfig& config, std::size_t wanted) {
  if (image.cols <= 2 * kBorder || image.rows <= 2 * kBorder) return {};
  std::vector<Corner> corners = detect_corners(image, config.fast_threshold, config.min_corner_share);
  if (3 * corners.size() >= wanted) return corners;
  const int least = least_contrast(image);
  if (least >= config.fast_threshold) return corners;
  return detect_corners(image, least, config.min_corner_share);
}

}  // namespace

std::vector<Corner> spread_corners(const std::vector<Corner>& corners, int width, int height, int count) {
  if (count <= 0 || corners.empty()) return {};
  const double cell = std::max(1.0, std::sqrt(static_cast<double>(width) * height / count));
  const auto columns = static_cast<std::size_t>(width / cell) + 1;
  const auto rows = static_cast<std::size_t>(height / cell) + 1;
  std::vector<std::vector<Corner>> cells(columns * rows);
  std::size_t most = 0;
  for (const Corner& corner : corners) {
    auto& members =
        cells[static_cast<std::size_t>(corner.y / cell) * columns + static_cast<std::size_t>(corner.x / cell)];
    members.push_back(corner);
    most = std::max(most, members.size());
  }
  for (auto& members : cells) std::sort(members.begin(), members.end(), is_better);
  std::vector<Corner> chosen;
  for (std::size_t rank = 0; rank < most && chosen.size() < static_cast<std::size_t>(count); ++rank) {
    const auto first = static_cast<std::ptrdiff_t>(chosen.size());
    for (const auto& members : cells) {
      if (rank < members.size()) chosen.push_back(members[rank]);
    }
    std::sort(chosen.begin() + first, chosen.end(), is_better);
  }
  chosen.resize(std::min(chosen.size(), static_cast<std::size_t>(count)));
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

  // Appends the features of a level.
  void extract(const Level& level, int octave, int count, std::vector<Feature>& features) const {
    std::vector<cv::KeyPoint> points;
    const auto corners = find_corners(level.image, config, static_cast<std::size_t>(count));
    for (const Corner& corner : spread_corners(corners, level.image.cols, level.image.rows, count)) {
      points.emplace_back(static_cast<float>(corner.x), static_cast<float>(corner.y), 2.0F * kPatchRadius + 1.0F,
                          corner_angle(level.image, corner.x, corner.y), corner.score);
    }
    if (points.empty()) return;
    cv::Mat descriptors;
    orb->compute(level.image, points, descriptors);
    for (std::size_t i = 0; i < points.size(); ++i) {
      Feature feature;
      // cv::resize aligns the borders of the images, not pixel centres, and the level's size is rounded.
      feature.pixel = {(points[i].pt.x + 0.5) * level.ratio_x - 0.5, (points[i].pt.y + 0.5) * level.ratio_y - 0.5};
      feature.octave = octave;
      std::memcpy(feature.descriptor.data(), descriptors.ptr(static_cast<int>(i)), sizeof(Descriptor));
      features.push_back(feature);
    }
  }
};

FeatureExtractor::FeatureExtractor(const FeatureConfig& config) : implementation_(new Implementation{config, {}}) {
  // ORB only computes descriptors, one level at a time: the pyramid is built once, in this class.
  implementation_->orb = cv::ORB::create(config.max_features, static_cast<float>(config.scale_factor), 1,
                                         kPatchRadius + 1, 0, 2, cv::ORB::HARRIS_SCORE, 2 * kPatchRadius + 1);
}

FeatureExtractor::~FeatureExtractor() = default;

std::vector<Feature> FeatureExtractor::extract(const geometry::GrayImage& image) const {
  if (image.width <= 2 * kBorder || image.height <= 2 * kBorder) return {};
  const cv::Mat view(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
  const std::vector<Level> levels = implementation_->build_pyramid(view);
  double area = 0.0;
  for (const Level& level : levels) area += 1.0 / (level.scale * level.scale);
  std::vector<Feature> features;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    // Levels share the budget by area.
    const double share = 1.0 / (levels[i].scale * levels[i].scale * area);
    implementation_->extract(levels[i], static_cast<int>(i),
                             static_cast<int>(std::lround(share * implementation_->config.max_features)), features);
  }
  return features;
}

}  // namespace lapis::slam
