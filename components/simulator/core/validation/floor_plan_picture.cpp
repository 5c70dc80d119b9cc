#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "simulator/core/robot/nav_map_picture.hpp"
#include "simulator/core/robot/starts.hpp"
#include "simulator/core/validation/drive_checks.hpp"
#include "simulator/core/validation/validate.hpp"

namespace lapis::simulator {
namespace {

const cv::Scalar kRoom(120, 120, 120), kStart(20, 140, 40), kTour(205, 40, 40), kLoop(40, 70, 205);
constexpr int kScale = 2;  // pixels per cell
constexpr double kArrow_m = 0.5;

/// Draws on the navigation map, in the world frame [m].
class Canvas {
 public:
  Canvas(const NavMap& map, const geometry::GrayImage& reachable) : grid_(map.grid()) {
    geometry::ColorImage plain = draw_nav_map(map, reachable);
    const cv::Mat pixels(plain.height, plain.width, CV_8UC3, plain.pixels.data());
    cv::resize(pixels, canvas_, {}, kScale, kScale, cv::INTER_NEAREST);
  }

  void line(const Path& path, const cv::Scalar& color, int width_px, bool is_closed = false) {
    std::vector<cv::Point> points;
    for (const auto& p : path) points.push_back(pixel(p));
    cv::polylines(canvas_, points, is_closed, color, width_px, cv::LINE_AA);
  }
  void arrow(const StartPose& pose, const cv::Scalar& color) {
    const Eigen::Vector2d tip =
        pose.position + kArrow_m * Eigen::Vector2d(std::cos(pose.yaw_rad), std::sin(pose.yaw_rad));
    cv::circle(canvas_, pixel(pose.position), 6, color, cv::FILLED, cv::LINE_AA);
    cv::arrowedLine(canvas_, pixel(pose.position), pixel(tip), color, 3, cv::LINE_AA, 0, 0.3);
  }
  void text(const Eigen::Vector2d& middle, const std::string& text, const cv::Scalar& color) {
    const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.5, 1, nullptr);
    const cv::Point corner = pixel(middle) + cv::Point(-size.width / 2, size.height / 2);
    cv::putText(canvas_, text, corner, cv::FONT_HERSHEY_SIMPLEX, 0.5, color, 1, cv::LINE_AA);
  }
  geometry::ColorImage image() const {
    geometry::ColorImage out(canvas_.cols, canvas_.rows);
    canvas_.copyTo(cv::Mat(out.height, out.width, CV_8UC3, out.pixels.data()));
    return out;
  }

 private:
  cv::Point pixel(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d q = kScale * (p - grid_.origin) / grid_.resolution_m;
    return {static_cast<int>(q.x()), canvas_.rows - 1 - static_cast<int>(q.y())};
  }

  const Grid& grid_;
  cv::Mat canvas_;
};

void draw_tour(Canvas& canvas, const World& world, const StartPose& start, const TourConfig& config) {
  try {
    for (const TourLeg& leg : plan_tour(world.nav_map(), start.position, world.scene().tour, config).legs)
      canvas.line(leg.path, kTour, 2);
  } catch (const std::runtime_error&) {
    canvas.line(world.scene().tour, kTour, 1);  // straight lines; check_tour reports what is wrong
  }
}

}  // namespace

geometry::ColorImage draw_floor_plan(const World& world, const TourConfig& tour) {
  const Scene& scene = world.scene();
  const NavMap& map = world.nav_map();
  const auto starts = starts_of(scene, map, tour.path.radius_m);
  Canvas canvas(map, map.reachable(starts.front().position, tour.path.radius_m));
  for (const Room& room : scene.rooms) {
    canvas.line(room.polygon, kRoom, 1, true);
    Eigen::Vector2d sum(0, 0);
    for (const auto& corner : room.polygon) sum += corner;
    canvas.text(sum / static_cast<double>(room.polygon.size()), room.id, kRoom);
  }
  for (const FreeLoop& loop : long_loops(scene, map, tour.path.radius_m)) {
    canvas.line(loop.path, kLoop, 2);
    canvas.text(loop.island, decimal(loop.length_m, 1) + " m", kLoop);
  }
  draw_tour(canvas, world, starts.front(), tour);
  for (const StartPose& start : starts) canvas.arrow(start, kStart);
  return canvas.image();
}

}  // namespace lapis::simulator
