#include "synthetic_dataset.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace lapis::sensor_replay::test {
namespace {

namespace fs = std::filesystem;

void write_image(const fs::path& file, const cv::Mat& image) {
  if (!cv::imwrite(file.string(), image)) throw std::runtime_error("cannot write " + file.string());
}

std::string stem(int frame) {
  char text[16];
  std::snprintf(text, sizeof text, "%05d", frame);
  return text;
}

cv::Mat color_image(int frame) {
  cv::Mat image(kHeight, kWidth, CV_8UC3);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const auto pixel = synthetic_color(frame, column, row);
      image.at<cv::Vec3b>(row, column) = {pixel.b, pixel.g, pixel.r};
    }
  }
  return image;
}

template <class Pixel>
cv::Mat gray_image(int frame, std::uint16_t (*formula)(int, int, int)) {
  cv::Mat_<Pixel> image(kHeight, kWidth);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      image(row, column) = static_cast<Pixel>(formula(frame, column, row));
    }
  }
  return image;
}

}  // namespace

geometry::Rgb8 synthetic_color(int frame, int column, int row) {
  return {static_cast<std::uint8_t>(column), static_cast<std::uint8_t>(100 + row),
          static_cast<std::uint8_t>(200 + frame)};
}

std::uint16_t synthetic_depth(int frame, int column, int row) {
  return static_cast<std::uint16_t>(1000 + 100 * frame + column + 2 * row);
}

std::uint16_t synthetic_label(int frame, int column, int row) {
  return static_cast<std::uint16_t>((frame + column + row) % 4);
}

void write_dataset(const fs::path& folder, int frames) {
  for (const char* part : {"rgb", "depth", "label"}) fs::create_directories(folder / part);
  std::string rgb = "# color images\n# timestamp filename\n";
  std::string depth = "# depth maps\n";
  std::string truth = "# timestamp tx ty tz qx qy qz qw\n";
  for (int i = 0; i < frames; ++i) {
    const std::string stamp = std::to_string(i / 10) + "." + std::to_string(i % 10) + "00000";
    write_image(folder / "rgb" / (stem(i) + ".png"), color_image(i));
    write_image(folder / "depth" / (stem(i) + ".png"), gray_image<std::uint16_t>(i, synthetic_depth));
    write_image(folder / "label" / (stem(i) + ".png"), gray_image<std::uint8_t>(i, synthetic_label));
    rgb += stamp + " rgb/" + stem(i) + ".png\n";
    depth += stamp + " depth/" + stem(i) + ".png\n";
    truth += stamp + " " + std::to_string(0.1 * i) + " 0 1 0 0 0 1\n";
  }
  write_text(folder / "rgb.txt", rgb);
  write_text(folder / "depth.txt", depth);
  write_text(folder / "groundtruth.txt", truth);
  write_text(folder / "camera.yaml", kCameraFile);
}

void write_text(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void truncate(const fs::path& file, double share) {
  fs::resize_file(file, static_cast<std::uintmax_t>(static_cast<double>(fs::file_size(file)) * share));
}

void write_gray8(const fs::path& file, int width, int height, int value) {
  write_image(file, cv::Mat(height, width, CV_8UC1, cv::Scalar(value)));
}

void write_gray16(const fs::path& file, const geometry::Image<std::uint16_t>& image) {
  cv::Mat_<std::uint16_t> mat(image.height, image.width);
  std::copy(image.pixels.begin(), image.pixels.end(), mat.begin());
  write_image(file, mat);
}

void write_rgb8(const fs::path& file, int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  // Noise does not compress, so that a truncated file lacks pixels and not just the trailer.
  cv::theRNG().state = 1;
  cv::randu(image, cv::Scalar::all(0), cv::Scalar::all(255));
  write_image(file, image);
}

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace lapis::sensor_replay::test
