#include "simulator/core/validation/feature_check.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "simulator/core/noise/color_noise.hpp"
#include "simulator/core/noise/random.hpp"
#include "simulator/core/robot/starts.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {
namespace {

constexpr double kViewSpacing_m = 0.5;
constexpr int kHeadings = 8;
constexpr int kMaxFeatures = 1000, kFewFeatures = 100;
constexpr double kMostPoor = 0.04, kLeastPoor = 0.005;
constexpr std::size_t kWorstShown = 4;
constexpr std::size_t kJudgedEvery = 100;
constexpr double kSurely = 1e-4;
constexpr std::uint64_t kSeed = 1;

std::vector<FeatureView> reachable_views(const World& world, double radius_m) {
  const NavMap& map = world.nav_map();
  std::vector<geometry::GrayImage> reachable;
  for (const StartPose& start : starts_of(world.scene(), map, radius_m))
    reachable.push_back(map.reachable(start.position, radius_m));
  const Grid& grid = map.grid();
  const int step = std::max(1, static_cast<int>(std::lround(kViewSpacing_m / grid.resolution_m)));
  std::vector<FeatureView> views;
  for (int row = step / 2; row < grid.height; row += step) {
    for (int column = step / 2; column < grid.width; column += step) {
      if (std::none_of(reachable.begin(), reachable.end(), [&](const auto& cells) { return cells(column, row) != 0; }))
        continue;
      for (int i = 0; i < kHeadings; ++i)
        views.push_back({grid.center({column, row}), 2.0 * std::numbers::pi * i / kHeadings, 0});
    }
  }
  return views;
}

/// At most `count` of the views, in a fixed random order.
std::vector<FeatureView> drawn(const std::vector<FeatureView>& views, std::size_t count) {
  const Random random(kSeed, RandomStream::kTruth);
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return random.bits(a) < random.bits(b); });
  order.resize(std::min(count, order.size()));
  std::vector<FeatureView> out;
  for (const std::size_t i : order) out.push_back(views[i]);
  return out;
}

bool is_poor(const FeatureView& view) { return view.features < kFewFeatures; }

int count_features(cv::ORB& orb, geometry::ColorImage image) {
  cv::Mat gray;
  cv::cvtColor(cv::Mat(image.height, image.width, CV_8UC3, image.pixels.data()), gray, cv::COLOR_RGB2GRAY);
  std::vector<cv::KeyPoint> keypoints;
  orb.detect(gray, keypoints);
  return static_cast<int>(keypoints.size());
}

std::string room_at(const Scene& scene, const Eigen::Vector2d& p) {
  const auto room = std::find_if(scene.rooms.begin(), scene.rooms.end(),
                                 [&](const Room& candidate) { return contains(candidate.polygon, p); });
  return room == scene.rooms.end() ? "elsewhere" : room->id;
}

std::string describe(const FeatureView& view) {
  return "(" + decimal(view.position.x(), 2) + ", " + decimal(view.position.y(), 2) + ") at " +
         decimal(view.yaw_rad * 180.0 / std::numbers::pi, 0) + " deg: " + std::to_string(view.features);
}

/// True when too many poor views make a scene fail: not when they are intended, and not when others made the scene.
bool is_bound(const Scene& scene) {
  const bool has_pictures = std::any_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& instance) {
    return scene.labels.name(instance.class_id) == "picture";
  });
  return !scene.is_stress && !scene.rooms.empty() && has_pictures;
}

struct RoomViews {
  std::size_t all = 0;
  std::vector<FeatureView> poor;
};

/// A line for every room with poor views, which lists its worst ones; the room with most poor views comes first.
std::vector<std::string> worst_places(const Scene& scene, const std::vector<FeatureView>& sorted) {
  std::map<std::string, RoomViews> views_of;
  for (const FeatureView& view : sorted) {
    RoomViews& room = views_of[room_at(scene, view.position)];
    ++room.all;
    if (is_poor(view)) room.poor.push_back(view);
  }
  std::vector<std::pair<std::string, RoomViews>> rooms(views_of.begin(), views_of.end());
  std::erase_if(rooms, [](const auto& room) { return room.second.poor.empty(); });
  std::stable_sort(rooms.begin(), rooms.end(),
                   [](const auto& a, const auto& b) { return a.second.poor.size() > b.second.poor.size(); });
  std::vector<std::string> lines;
  for (const auto& [id, views] : rooms) {
    std::string line = id + ": " + std::to_string(views.poor.size()) + " of " + std::to_string(views.all) + " views";
    for (std::size_t i = 0; i < std::min(kWorstShown, views.poor.size()); ++i)
      line += (i == 0 ? "; " : ", ") + describe(views.poor[i]);
    lines.push_back(line);
  }
  return lines;
}

}  // namespace

bool is_decided(std::size_t poor, std::size_t views) {
  const auto n = static_cast<double>(views);
  const double log_share = std::log(kMostPoor), log_rest = std::log1p(-kMostPoor);
  double fewer = 0.0, probability = 0.0;
  for (std::size_t i = 0; i <= poor; ++i) {
    const auto k = static_cast<double>(i);
    fewer += probability;
    probability = std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) + k * log_share +
                           (n - k) * log_rest);
  }
  return fewer + probability < kSurely || 1.0 - fewer < kSurely;
}

std::vector<FeatureView> measure_features(const World& world, const FeatureConfig& config, const Progress& progress) {
  auto views = drawn(reachable_views(world, config.robot_radius_m), config.max_views);
  const ColorNoise noise({}, kSeed);
  const auto orb = cv::ORB::create(kMaxFeatures);
  orb->setFastThreshold(20);
  std::size_t poor = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (i % kJudgedEvery == 0) {
      if (is_decided(poor, i)) {
        views.resize(i);
        break;
      }
      progress("features: view " + std::to_string(i) + " of at most " + std::to_string(views.size()));
    }
    FeatureView& view = views[i];
    const auto T = T_world_camera(world, config.mount, view.position, view.yaw_rad);
    view.features = count_features(*orb, noise.apply(world.renderer().render(config.camera, T).color, i));
    poor += is_poor(view) ? 1 : 0;
  }
  return views;
}

Check check_features(const Scene& scene, std::vector<FeatureView> views) {
  if (views.empty()) return {"features", Verdict::kNote, "no view can be reached", {}};
  std::stable_sort(views.begin(), views.end(), [](const auto& a, const auto& b) { return a.features < b.features; });
  const auto count = static_cast<double>(views.size());
  const auto poor = std::count_if(views.begin(), views.end(), is_poor);
  const double share = static_cast<double>(poor) / count;
  const double sum = std::accumulate(views.begin(), views.end(), 0.0,
                                     [](double total, const FeatureView& v) { return total + v.features; });
  Check check{"features"};
  check.figures = decimal(100.0 * share, 2) + " % of " + std::to_string(views.size()) + " views have fewer than " +
                  std::to_string(kFewFeatures) + " ORB features; mean " + decimal(sum / count, 0) +
                  ", 5th percentile " + std::to_string(views[views.size() / 20].features);
  if (share > kMostPoor) check.verdict = is_bound(scene) ? Verdict::kFail : Verdict::kNote;
  if (share < kLeastPoor) check.verdict = Verdict::kNote;
  check.details = worst_places(scene, views);
  return check;
}

}  // namespace lapis::simulator
