#include "simulator/core/robot/nav_map_picture.hpp"

#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "simulator/core/robot/grid_steps.hpp"

namespace lapis::simulator {
namespace {

constexpr geometry::Rgb8 kFree{255, 255, 255}, kBlocked{0, 0, 0}, kReachable{190, 225, 245};
constexpr std::array<geometry::Rgb8, 4> kLines{{{200, 30, 30}, {30, 130, 40}, {40, 60, 200}, {190, 120, 0}}};
constexpr int kLineWidth_px = 2;

geometry::Rgb8 color_of(const NavMap& map, const geometry::GrayImage& reachable, Cell c) {
  if (map.is_blocked(c)) return kBlocked;
  return is_set(reachable, c) ? kReachable : kFree;
}

void draw_line(geometry::ColorImage& image, const Grid& grid, const Path& line, geometry::Rgb8 color) {
  cv::Mat canvas(image.height, image.width, CV_8UC3, image.pixels.data());
  std::vector<cv::Point> points;
  for (const auto& p : line) {
    const Cell c = grid.cell_of(p);
    points.emplace_back(c.column, grid.height - 1 - c.row);
  }
  cv::polylines(canvas, points, false, cv::Scalar(color.r, color.g, color.b), kLineWidth_px);
}

}  // namespace

geometry::ColorImage draw_nav_map(const NavMap& map, const geometry::GrayImage& reachable,
                                  const std::vector<Path>& lines) {
  const Grid& grid = map.grid();
  geometry::ColorImage image(grid.width, grid.height);
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column)
      image(column, grid.height - 1 - row) = color_of(map, reachable, {column, row});
  }
  for (std::size_t i = 0; i < lines.size(); ++i) draw_line(image, grid, lines[i], kLines[i % kLines.size()]);
  return image;
}

std::vector<std::uint8_t> encode_png(const geometry::ColorImage& image) {
  geometry::ColorImage copy = image;
  cv::Mat pixels(copy.height, copy.width, CV_8UC3, copy.pixels.data());
  cv::cvtColor(pixels, pixels, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", pixels, bytes);
  return bytes;
}

}  // namespace lapis::simulator
