#include "slam/core/calibration/depth_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/core/optim.hpp>
#include <opencv2/imgproc.hpp>

namespace lapis::slam {
namespace {

constexpr double kJumpShare = 1.08, kJump_m = 0.1;  // far is at least that much farther than near
constexpr int kWidestGap_px = 8;                    // without depth, between near and far
constexpr int kBorder_px = 2;
constexpr float kNearest_m = 0.1F;        // nearer things would move by any number of pixels
constexpr std::size_t kMostEdges = 2000;  // more say the same again
constexpr double kMostContrast = 4.0;     // times the mean: few strong edges shall not decide
constexpr int kTiles = 4;                 // in each direction, of an image

/// Mean contrast of grey values across columns (`dx` = 1) or rows is 1.
cv::Mat contrast_of(const cv::Mat& gray, int dx) {
  cv::Mat slope;
  cv::Sobel(gray, slope, CV_32F, dx, 1 - dx);
  slope = cv::abs(slope);
  const double mean = std::max(cv::mean(slope)[0], 1e-6);
  slope = cv::min(slope / mean, kMostContrast);
  return slope / std::max(cv::mean(slope)[0], 1e-6);
}

std::array<geometry::Image<float>, EdgeView::kLevels> pyramid_of(cv::Mat image) {
  std::array<geometry::Image<float>, EdgeView::kLevels> levels;
  for (auto& level : levels) {
    level = geometry::Image<float>(image.cols, image.rows);
    image.copyTo(cv::Mat(image.rows, image.cols, CV_32F, level.pixels.data()));
    cv::Mat half;
    cv::pyrDown(image, half);
    image = half;
  }
  return levels;
}

/// Depth of what is seen beside a pixel, behind a gap without depth; 0: none.
float beside(const geometry::DepthImage& depth, int column, int row, int right, int down) {
  for (int step = 1; step <= kWidestGap_px; ++step) {
    const int u = column + step * right, v = row + step * down;
    if (u < 0 || v < 0 || u >= depth.width || v >= depth.height) return 0.0F;
    if (depth(u, v) > 0.0F) return depth(u, v);
  }
  return 0.0F;
}

std::vector<EdgeView::Edge> edges_of(const geometry::DepthImage& depth) {
  constexpr std::array<std::pair<int, int>, 4> kBeside{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  std::vector<EdgeView::Edge> all;
  for (int row = kBorder_px; row < depth.height - kBorder_px; ++row) {
    for (int column = kBorder_px; column < depth.width - kBorder_px; ++column) {
      const float near = depth(column, row);
      if (near < kNearest_m) continue;
      for (const auto& [right, down] : kBeside) {
        const float far = beside(depth, column, row, right, down);
        if (far < kJumpShare * near || far - near < kJump_m) continue;
        const Eigen::Vector2f half{0.5F * static_cast<float>(right), 0.5F * static_cast<float>(down)};
        all.push_back({Eigen::Vector2f(column, row) + half, near, right != 0});
      }
    }
  }
  const std::size_t stride = all.size() / kMostEdges + 1;
  std::vector<EdgeView::Edge> edges;
  for (std::size_t i = 0; i < all.size(); i += stride) edges.push_back(all[i]);
  return edges;
}

/// Speed of the image of an edge [px/s] [Longuet-Higgins and Prazdny, "The interpretation of a moving retinal image",
/// 1980].
Eigen::Vector2d speed_of(const EdgeView& view, const EdgeView::Edge& edge) {
  const geometry::PinholeCamera& camera = view.camera();
  const double x = (edge.pixel.x() - camera.cx) / camera.fx, y = (edge.pixel.y() - camera.cy) / camera.fy;
  const Eigen::Vector3d v = view.velocity().head<3>() / edge.depth_m, w = view.velocity().tail<3>();
  return {camera.fx * (-v.x() + x * v.z() + x * y * w.x() - (1.0 + x * x) * w.y() + y * w.z()),
          camera.fy * (-v.y() + y * v.z() + (1.0 + y * y) * w.x() - x * y * w.y() - x * w.z())};
}

Eigen::Vector2d moved(const EdgeView& view, const EdgeView::Edge& edge, const DepthOffset& offset) {
  const geometry::PinholeCamera& camera = view.camera();
  const Eigen::Vector2d centre{camera.cx, camera.cy};
  return centre + offset.focal_ratio * (edge.pixel.cast<double>() - centre) +
         Eigen::Vector2d(camera.fx, camera.fy).cwiseProduct(offset.shift_m) / edge.depth_m -
         offset.delay_s * speed_of(view, edge);
}

/// An edge that leaves the image is taken where it was, so that nothing is gained by that.
double contrast_at(const EdgeView& view, const EdgeView::Edge& edge, const DepthOffset& offset, int level) {
  const Eigen::Vector2d pixel = moved(view, edge, offset);
  const bool is_inside = view.camera().contains(pixel, std::ldexp(1.0, level));
  return view.contrast(is_inside ? pixel : edge.pixel.cast<double>(), edge.is_upright, level);
}

/// Mean contrast at every `stride`th edge.
double score(std::span<const EdgeView> views, const DepthOffset& offset, int level, std::size_t stride) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const EdgeView& view : views) {
    for (std::size_t i = 0; i < view.edges().size(); i += stride, ++count) {
      sum += contrast_at(view, view.edges()[i], offset, level);
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

DepthOffset coarse_offset(std::span<const EdgeView> views) {
  constexpr int kRatios = 13, kShifts = 8;  // on either side
  constexpr std::size_t kStride = 5;
  DepthOffset best;
  double highest = -std::numeric_limits<double>::infinity();
  for (int i = -kRatios + 1; i <= kRatios + 2; ++i) {
    for (int j = -kShifts; j <= kShifts; ++j) {
      const DepthOffset offset{1.0 + 0.02 * i, {0.01 * j, 0.0}};
      const double here = score(views, offset, EdgeView::kLevels - 1, kStride);
      if (here <= highest) continue;
      highest = here;
      best = offset;
    }
  }
  return best;
}

/// Parameters in pixels: those at a quarter of the width beside the centre, those of a shift at the median depth, and
/// those of a delay at the mean speed. A delay is sought where there is one to begin with.
class Search : public cv::MinProblemSolver::Function {
 public:
  Search(std::span<const EdgeView> views, const DepthOffset& start, int level)
      : views_(views), start_(start), level_(level), per_ratio_px_(0.25 * views.front().camera().width),
        per_delay_px_(moved_px(views, {.delay_s = 1.0})) {
    std::vector<float> depths;
    for (const EdgeView& view : views) {
      for (const auto& edge : view.edges()) depths.push_back(edge.depth_m);
    }
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    per_shift_px_ = views.front().camera().fx / *middle;
  }
  int getDims() const override { return start_.delay_s == 0.0 ? 3 : 4; }
  double calc(const double* x) const override { return -score(views_, offset(x), level_, 1); }
  DepthOffset offset(const double* x) const {
    const double delay_s = start_.delay_s == 0.0 ? 0.0 : start_.delay_s + x[3] / per_delay_px_;
    return {start_.focal_ratio + x[0] / per_ratio_px_, start_.shift_m + Eigen::Vector2d(x[1], x[2]) / per_shift_px_,
            delay_s};
  }

 private:
  std::span<const EdgeView> views_;
  DepthOffset start_;
  int level_;
  double per_ratio_px_, per_delay_px_, per_shift_px_ = 1.0;
};

/// Nelder and Mead's method, from coarse levels to fine ones.
DepthOffset refined(std::span<const EdgeView> views, DepthOffset offset) {
  constexpr int kMostSteps = 100;
  for (int level = EdgeView::kLevels - 2; level >= 0; --level) {
    const auto search = cv::makePtr<Search>(views, offset, level);
    const double step_px = std::ldexp(1.0, level);
    const auto solver = cv::DownhillSolver::create(
        search, cv::Mat(1, search->getDims(), CV_64F, cv::Scalar(step_px)),
        cv::TermCriteria(cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, kMostSteps, 1e-5));
    cv::Mat x = cv::Mat::zeros(1, search->getDims(), CV_64F);
    solver->minimize(x);
    offset = search->offset(x.ptr<double>());
  }
  return offset;
}

/// Mean gain of contrast over that of a reference, over its standard error. A tile of the image is one sample, for all
/// views together: the edges in it belong to few things, and a camera that stands shows the same ones again.
double gain_sigmas(std::span<const EdgeView> views, const DepthOffset& offset, const DepthOffset& reference) {
  constexpr int kFewest = 10;           // edges of a tile
  constexpr double kFewestTiles = 8.0;  // fewer agree by chance, or because they show one thing
  struct Sum {
    double gain = 0.0;
    int edges = 0;
  };
  std::map<std::pair<int, int>, Sum> tiles;
  for (const EdgeView& view : views) {
    const auto tile = [](float at, int size) { return static_cast<int>(at * kTiles) / size; };
    for (const auto& edge : view.edges()) {
      Sum& sum = tiles[{tile(edge.pixel.x(), view.camera().width), tile(edge.pixel.y(), view.camera().height)}];
      sum.gain += contrast_at(view, edge, offset, 0) - contrast_at(view, edge, reference, 0);
      ++sum.edges;
    }
  }
  double n = 0.0, mean = 0.0, squares = 0.0;
  for (const auto& [tile, sum] : tiles) {
    if (sum.edges < kFewest) continue;
    const double gain = sum.gain / sum.edges;
    n += 1.0;
    const double before = mean;
    mean += (gain - mean) / n;
    squares += (gain - before) * (gain - mean);
  }
  return n >= kFewestTiles && squares > 0.0 ? mean / std::sqrt(squares / (n - 1.0) / n) : 0.0;
}

/// In steps by which edges move by about a pixel of a coarse level: 0 where less than that is off.
DepthOffset coarse_delay(std::span<const EdgeView> views, double most_s, DepthOffset offset) {
  constexpr int kLevel = 1;
  const int sides = std::max(1, static_cast<int>(moved_px(views, {.delay_s = most_s}) / std::ldexp(1.0, kLevel)));
  double best = 0.0;
  double highest = -std::numeric_limits<double>::infinity();
  for (int i = -sides; i <= sides; ++i) {
    offset.delay_s = most_s * i / sides;
    const double here = score(views, offset, kLevel, 5);
    if (here <= highest) continue;
    highest = here;
    best = offset.delay_s;
  }
  offset.delay_s = best;
  return offset;
}

DepthAlignment alignment(std::span<const EdgeView> views, const DepthOffset& offset) {
  return {offset, moved_px(views, offset), gain_sigmas(views, offset, {})};
}

}  // namespace

EdgeView::EdgeView(const RgbdFrame& frame) : camera_(frame.camera), edges_(edges_of(frame.depth)) {
  const cv::Mat raw(frame.gray.height, frame.gray.width, CV_8U, const_cast<std::uint8_t*>(frame.gray.pixels.data()));
  cv::Mat gray;
  cv::GaussianBlur(raw, gray, {3, 3}, 0.0);
  across_columns_ = pyramid_of(contrast_of(gray, 1));
  across_rows_ = pyramid_of(contrast_of(gray, 0));
}

double EdgeView::contrast(const Eigen::Vector2d& pixel, bool is_upright, int level) const {
  const auto& image = (is_upright ? across_columns_ : across_rows_)[static_cast<std::size_t>(level)];
  const Eigen::Vector2d at = std::ldexp(1.0, -level) * pixel;
  if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < image.width - 1 && at.y() < image.height - 1)) return 1.0;
  const int u = static_cast<int>(at.x()), v = static_cast<int>(at.y());
  const double right = at.x() - u, down = at.y() - v;
  return (1.0 - down) * ((1.0 - right) * image(u, v) + right * image(u + 1, v)) +
         down * ((1.0 - right) * image(u, v + 1) + right * image(u + 1, v + 1));
}

double moved_px(std::span<const EdgeView> views, const DepthOffset& offset) {
  double squares = 0.0;
  std::size_t count = 0;
  for (const EdgeView& view : views) {
    for (const auto& edge : view.edges()) {
      squares += (moved(view, edge, offset) - edge.pixel.cast<double>()).squaredNorm();
    }
    count += view.edges().size();
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
}

DepthAlignment align_depth(std::span<const EdgeView> views) {
  return alignment(views, refined(views, coarse_offset(views)));
}

LateAlignment align_late_depth(std::span<const EdgeView> views, double most_s, const DepthOffset& stated) {
  std::vector<DepthOffset> starts{coarse_delay(views, most_s, {})};
  if (!(stated == DepthOffset{})) starts.push_back(coarse_delay(views, most_s, stated));
  std::optional<DepthOffset> best;
  for (const DepthOffset& start : starts) {
    if (start.delay_s == 0.0) continue;
    const DepthOffset found = refined(views, start);
    if (!best || score(views, found, 0, 1) > score(views, *best, 0, 1)) best = found;
  }
  if (!best) return {};
  const DepthAlignment late{*best, moved_px(views, *best), gain_sigmas(views, *best, stated)};
  return {late, gain_sigmas(views, *best, refined(views, coarse_offset(views)))};
}

}  // namespace lapis::slam
