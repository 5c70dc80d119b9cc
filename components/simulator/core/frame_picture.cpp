#include "simulator/core/frame_picture.hpp"

#include <algorithm>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/files/atomic_file.hpp"

namespace lapis::simulator {
namespace {

constexpr float kNearlyBlack_m = 8.0F;  // this depth and all greater ones are nearly black
constexpr int kCaption_px = 16;

cv::Mat view_of(const geometry::ColorImage& image) {
  return {image.height, image.width, CV_8UC3, const_cast<geometry::Rgb8*>(image.pixels.data())};  // is only read
}

geometry::Rgb8 depth_color(float depth_m) {
  if (!(depth_m > 0.0F)) return {};
  const auto level = static_cast<std::uint8_t>(255.0F * std::max(0.05F, 1.0F - depth_m / kNearlyBlack_m));
  return {level, level, level};
}

void write(const std::filesystem::path& file, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(file.extension().string(), image, bytes);
  if (const auto reason = files::replace_file(file.string(), bytes)) throw std::runtime_error(*reason);
}

}  // namespace

geometry::ColorImage side_by_side(const RenderedFrame& frame, const mapping::LabelList& labels) {
  const int width = frame.depth.width, height = frame.depth.height;
  geometry::ColorImage out(3 * width, height);
  std::vector<geometry::Rgb8> colors(65536);
  for (std::size_t id = 0; id < colors.size(); ++id) colors[id] = labels.color(static_cast<std::uint16_t>(id));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      out(x, y) = frame.color(x, y);
      out(x + width, y) = depth_color(frame.depth(x, y));
      out(x + 2 * width, y) = frame.depth(x, y) > 0.0F ? colors[frame.labels(x, y)] : geometry::Rgb8{};
    }
  }
  return out;
}

geometry::ColorImage contact_sheet(const std::vector<geometry::ColorImage>& pictures,
                                   const std::vector<std::string>& names, int columns, int width_px) {
  if (pictures.empty()) return {};
  const int height_px = width_px * pictures[0].height / pictures[0].width;
  const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
  geometry::ColorImage sheet(columns * width_px, rows * (height_px + kCaption_px), {255, 255, 255});
  cv::Mat canvas(sheet.height, sheet.width, CV_8UC3, sheet.pixels.data());
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    const cv::Rect place(column * width_px, row * (height_px + kCaption_px) + kCaption_px, width_px, height_px);
    cv::resize(view_of(pictures[i]), canvas(place), place.size(), 0, 0, cv::INTER_AREA);
    cv::putText(canvas, names[i], {place.x + 3, place.y - 4}, cv::FONT_HERSHEY_SIMPLEX, 0.4, {0, 0, 0}, 1, cv::LINE_AA);
  }
  return sheet;
}

void write_image(const std::filesystem::path& file, const geometry::ColorImage& image) {
  cv::Mat bgr;
  cv::cvtColor(view_of(image), bgr, cv::COLOR_RGB2BGR);
  write(file, bgr);
}

void write_image(const std::filesystem::path& file, const geometry::Image<std::uint16_t>& image) {
  write(file, {image.height, image.width, CV_16UC1, const_cast<std::uint16_t*>(image.pixels.data())});
}

}  // namespace lapis::simulator
