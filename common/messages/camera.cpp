#include "common/messages/camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/images/encoded_image.hpp"

namespace lapis::messages {
namespace {

using sensor_msgs::msg::Image;

constexpr std::uint32_t kLargestSide = 16384;  // [px]; products of sizes cannot overflow

/// The reason why an image's layout cannot be read; empty when it can be read.
std::string layout_problem(const Image& image, std::size_t bytes_per_pixel) {
  if (image.width() == 0 || image.height() == 0) return "image is empty";
  if (image.width() > kLargestSide || image.height() > kLargestSide) return "image is larger than 16384 pixels";
  if (image.step() < image.width() * bytes_per_pixel) return "image rows are shorter than their width";
  if (image.data().size() != static_cast<std::size_t>(image.step()) * image.height()) {
    return "image has not step x height bytes";  // no numbers, because reasons are keys of counters
  }
  if (image.is_bigendian() != 0 && bytes_per_pixel > 1) return "image is big-endian";
  return "";
}

/// The beginning of a received text. Its length is limited because reasons are keys of counters.
std::string shown(const std::string& text) {
  constexpr std::size_t kLongest = 32;
  return text.substr(0, kLongest);
}

template <class Pixel>
Pixel read(const std::uint8_t* bytes) {
  Pixel value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Applies `convert(pointer to the pixel's bytes)` to every pixel.
template <class Out, class Convert>
geometry::Image<Out> map_pixels(const Image& image, std::size_t bytes_per_pixel, Convert convert) {
  const std::size_t width = image.width(), height = image.height(), step = image.step();  // accessors are not inlined
  geometry::Image<Out> out(static_cast<int>(width), static_cast<int>(height));
  Out* target = out.pixels.data();
  for (std::size_t row = 0; row < height; ++row) {
    const std::uint8_t* bytes = image.data().data() + row * step;
    for (std::size_t column = 0; column < width; ++column, bytes += bytes_per_pixel) *target++ = convert(bytes);
  }
  return out;
}

std::uint8_t luminance(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  // 16-bit fixed point of 0.299, 0.587, 0.114, rounded.
  return static_cast<std::uint8_t>((19595u * r + 38470u * g + 7471u * b + 32768u) >> 16);
}

template <std::size_t kBytesPerPixel, class Convert>
Converted<geometry::GrayImage> gray(const Image& image, Convert convert) {
  const auto problem = layout_problem(image, kBytesPerPixel);
  if (!problem.empty()) return Converted<geometry::GrayImage>::refused("colour " + problem);
  return map_pixels<std::uint8_t>(image, kBytesPerPixel, convert);
}

/// Grey values of a 16-bit image in proportion to its own, of which 99 % stay below 255.
Converted<geometry::GrayImage> gray_of_wide(const Image& image) {
  const auto problem = layout_problem(image, sizeof(std::uint16_t));
  if (!problem.empty()) return Converted<geometry::GrayImage>::refused("colour " + problem);
  auto values = map_pixels<std::uint16_t>(image, 2, [](const std::uint8_t* p) { return read<std::uint16_t>(p); });
  auto sorted = values.pixels;
  const auto bright = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() - 1 - (sorted.size() - 1) / 100);
  std::nth_element(sorted.begin(), bright, sorted.end());
  const std::uint32_t white = std::max<std::uint32_t>(*bright, 255);
  geometry::GrayImage out(values.width, values.height);
  std::transform(values.pixels.begin(), values.pixels.end(), out.pixels.begin(), [white](std::uint32_t value) {
    return static_cast<std::uint8_t>(std::min(value, white) * 255 / white);
  });
  return out;
}

template <std::size_t kBytesPerPixel, class Convert>
Converted<geometry::ColorImage> color(const Image& image, Convert convert) {
  const auto problem = layout_problem(image, kBytesPerPixel);
  if (!problem.empty()) return Converted<geometry::ColorImage>::refused("colour " + problem);
  return map_pixels<geometry::Rgb8>(image, kBytesPerPixel, convert);
}

/// Colours of a yuv422 image (ITU-R BT.601, 16 to 235), in which two neighbours share Cb and Cr.
Converted<geometry::ColorImage> color_of_yuv(const Image& image, bool has_chroma_first) {
  const auto problem = layout_problem(image, 2);
  if (!problem.empty() || image.width() % 2 != 0) {
    return Converted<geometry::ColorImage>::refused("colour " + (problem.empty() ? "image has an odd width" : problem));
  }
  geometry::ColorImage out(static_cast<int>(image.width()), static_cast<int>(image.height()));
  const auto channel = [](double value) { return static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0)); };
  auto* target = out.pixels.data();
  const std::size_t luminance_at = has_chroma_first ? 1 : 0, chroma_at = 1 - luminance_at;
  for (std::size_t row = 0; row < image.height(); ++row) {
    const std::uint8_t* pair = image.data().data() + row * image.step();
    for (std::size_t column = 0; column < image.width(); column += 2, pair += 4) {
      const double cb = pair[chroma_at] - 128.0, cr = pair[chroma_at + 2] - 128.0;
      for (const std::size_t at : {luminance_at, luminance_at + 2}) {
        const double y = 255.0 / 219.0 * (pair[at] - 16.0);
        *target++ = {channel(y + 1.596 * cr), channel(y - 0.392 * cb - 0.813 * cr), channel(y + 2.017 * cb)};
      }
    }
  }
  return out;
}

bool has_chroma_first(const std::string& encoding) { return encoding == "yuv422" || encoding == "uyvy"; }
bool has_luminance_first(const std::string& encoding) { return encoding == "yuv422_yuy2" || encoding == "yuyv"; }

std::string not_a_color(const std::string& encoding) {
  return "colour encoding '" + shown(encoding) + "' is not rgb8, bgr8, rgba8, bgra8, mono8, mono16 or yuv422";
}

}  // namespace

Converted<geometry::LensCamera> lens_camera(const sensor_msgs::msg::CameraInfo& message) {
  using Result = Converted<geometry::LensCamera>;
  geometry::LensCamera camera;
  auto& pinhole = camera.pinhole;
  if (message.width() > kLargestSide || message.height() > kLargestSide)
    return Result::refused("camera info too large");
  pinhole.width = static_cast<int>(message.width());
  pinhole.height = static_cast<int>(message.height());
  pinhole.fx = message.k()[0];
  pinhole.fy = message.k()[4];
  pinhole.cx = message.k()[2];
  pinhole.cy = message.k()[5];
  if (!is_valid(pinhole)) return Result::refused("camera info has no valid size and focal length");
  camera.distortion = message.d();
  const std::string& model = message.distortion_model();
  const bool is_known = model == "plumb_bob" || model == "rational_polynomial";
  if (!is_known && !(model.empty() && !camera.is_distorted())) {
    return Result::refused("distortion model '" + shown(model) + "' is not plumb_bob or rational_polynomial");
  }
  constexpr std::array<std::size_t, 4> kLengths{0, 4, 5, 8};
  if (std::find(kLengths.begin(), kLengths.end(), camera.distortion.size()) == kLengths.end()) {
    return Result::refused("distortion of model '" + model + "' has not 4, 5 or 8 numbers");
  }
  if (!std::all_of(camera.distortion.begin(), camera.distortion.end(), [](double d) { return std::isfinite(d); })) {
    return Result::refused("distortion has numbers that are not finite");
  }
  return camera;
}

sensor_msgs::msg::CameraInfo to_camera_info(const geometry::LensCamera& camera, const std_msgs::msg::Header& header) {
  constexpr std::size_t kRational = 8;
  constexpr std::size_t kPlumbBob = 5;
  const geometry::PinholeCamera& c = camera.pinhole;
  sensor_msgs::msg::CameraInfo info;
  info.header(header);
  info.width(static_cast<std::uint32_t>(c.width));
  info.height(static_cast<std::uint32_t>(c.height));
  info.distortion_model(camera.distortion.size() == kRational ? "rational_polynomial" : "plumb_bob");
  info.d(camera.distortion.empty() ? std::vector<double>(kPlumbBob, 0.0) : camera.distortion);
  info.k({c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0});
  info.r({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  info.p({c.fx, 0.0, c.cx, 0.0, 0.0, c.fy, c.cy, 0.0, 0.0, 0.0, 1.0, 0.0});
  return info;
}

std::string size_problem(const std::string& what, int width, int height, const geometry::PinholeCamera& camera) {
  if (width == camera.width && height == camera.height) return "";
  const auto text = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
  return what + " image is " + text(width, height) + ", camera info says " + text(camera.width, camera.height);
}

Converted<geometry::ColorImage> to_color(const Image& message) {
  using Result = Converted<geometry::ColorImage>;
  using geometry::Rgb8;
  const std::string& encoding = message.encoding();
  const auto of_rgb = [](const std::uint8_t* p) { return Rgb8{p[0], p[1], p[2]}; };
  const auto of_bgr = [](const std::uint8_t* p) { return Rgb8{p[2], p[1], p[0]}; };
  if (encoding == "rgb8") return color<3>(message, of_rgb);
  if (encoding == "bgr8") return color<3>(message, of_bgr);
  if (encoding == "rgba8") return color<4>(message, of_rgb);
  if (encoding == "bgra8") return color<4>(message, of_bgr);
  if (has_chroma_first(encoding)) return color_of_yuv(message, true);
  if (has_luminance_first(encoding)) return color_of_yuv(message, false);
  const auto gray = to_gray(message);
  if (!gray) return Result::refused(gray.reason);
  geometry::ColorImage out(gray->width, gray->height);
  std::transform(gray->pixels.begin(), gray->pixels.end(), out.pixels.begin(), [](std::uint8_t value) {
    return Rgb8{value, value, value};
  });
  return out;
}

Converted<geometry::ColorImage> to_color(const sensor_msgs::msg::CompressedImage& message) {
  using Result = Converted<geometry::ColorImage>;
  const auto size = images::encoded_size(message.data());
  if (!size) return Result::refused("compressed colour image is neither JPEG nor PNG");
  if (size->width > kMostDecodedPixels / size->height) {
    return Result::refused("compressed colour image has more than 2^25 pixels");
  }
  auto decoded = images::decode_color(message.data());
  if (!decoded) return Result::refused("compressed colour image is damaged");
  return std::move(*decoded);
}

Converted<geometry::GrayImage> to_gray(const Image& message) {
  using Result = Converted<geometry::GrayImage>;
  const std::string& encoding = message.encoding();
  if (encoding == "mono8" || encoding == "8UC1") return gray<1>(message, [](const std::uint8_t* p) { return *p; });
  if (encoding == "mono16" || encoding == "16UC1") return gray_of_wide(message);
  if (has_chroma_first(encoding)) return gray<2>(message, [](const std::uint8_t* p) { return p[1]; });
  if (has_luminance_first(encoding)) return gray<2>(message, [](const std::uint8_t* p) { return *p; });
  const auto of_rgb = [](const std::uint8_t* p) { return luminance(p[0], p[1], p[2]); };
  const auto of_bgr = [](const std::uint8_t* p) { return luminance(p[2], p[1], p[0]); };
  if (encoding == "rgb8") return gray<3>(message, of_rgb);
  if (encoding == "bgr8") return gray<3>(message, of_bgr);
  if (encoding == "rgba8") return gray<4>(message, of_rgb);
  if (encoding == "bgra8") return gray<4>(message, of_bgr);
  return Result::refused(not_a_color(encoding));
}

Converted<geometry::DepthImage> to_depth(const Image& message) {
  using Result = Converted<geometry::DepthImage>;
  const std::string& encoding = message.encoding();
  if (encoding != "16UC1" && encoding != "mono16" && encoding != "32FC1") {
    return Result::refused("depth encoding '" + shown(encoding) + "' is not 16UC1 or 32FC1");
  }
  const std::size_t bytes = encoding == "32FC1" ? 4 : 2;
  if (const auto problem = layout_problem(message, bytes); !problem.empty()) return Result::refused("depth " + problem);
  if (bytes == 4) {
    return map_pixels<float>(message, 4, [](const std::uint8_t* p) {
      const auto metres = read<float>(p);
      return std::isfinite(metres) && metres > 0.0f ? metres : 0.0f;
    });
  }
  return map_pixels<float>(message, 2, [](const std::uint8_t* p) {
    const auto millimetres = read<std::uint16_t>(p);
    return millimetres == 65535 ? 0.0f : static_cast<float>(millimetres) * 0.001f;
  });
}

Converted<geometry::LabelImage> to_labels(const Image& message) {
  using Result = Converted<geometry::LabelImage>;
  const std::string& encoding = message.encoding();
  const bool is_wide = encoding == "mono16" || encoding == "16UC1";
  if (!is_wide && encoding != "mono8" && encoding != "8UC1") {
    return Result::refused("label encoding '" + shown(encoding) + "' is not mono8 or mono16");
  }
  const std::size_t bytes = is_wide ? 2 : 1;
  if (const auto problem = layout_problem(message, bytes); !problem.empty()) return Result::refused("label " + problem);
  if (!is_wide) {
    return map_pixels<std::uint16_t>(
        message, 1, [](const std::uint8_t* p) { return static_cast<std::uint16_t>(*p == 255 ? 0 : *p); });
  }
  return map_pixels<std::uint16_t>(message, 2, [](const std::uint8_t* p) {
    const auto id = read<std::uint16_t>(p);
    return static_cast<std::uint16_t>(id == 65535 ? 0 : id);
  });
}

Converted<geometry::ConfidenceImage> to_confidence(const Image& message) {
  using Result = Converted<geometry::ConfidenceImage>;
  const std::string& encoding = message.encoding();
  const bool is_float = encoding == "32FC1";
  if (!is_float && encoding != "mono8" && encoding != "8UC1") {
    return Result::refused("confidence encoding '" + shown(encoding) + "' is not 32FC1 or mono8");
  }
  const std::size_t bytes = is_float ? 4 : 1;
  if (const auto problem = layout_problem(message, bytes); !problem.empty()) {
    return Result::refused("confidence " + problem);
  }
  if (!is_float) return map_pixels<std::uint8_t>(message, 1, [](const std::uint8_t* p) { return *p; });
  return map_pixels<std::uint8_t>(message, 4, [](const std::uint8_t* p) {
    const auto share = read<float>(p);
    return static_cast<std::uint8_t>(share > 0.0f ? std::lround(std::min(share, 1.0f) * 255.0f) : 0);
  });
}

Image to_label_image(const geometry::LabelImage& labels, const std_msgs::msg::Header& header) {
  const bool fits = std::all_of(labels.pixels.begin(), labels.pixels.end(), [](auto id) { return id < 255; });
  if (!fits) return to_image(labels, "mono16", header);
  geometry::Image<std::uint8_t> narrow(labels.width, labels.height);
  std::transform(labels.pixels.begin(), labels.pixels.end(), narrow.pixels.begin(),
                 [](auto id) { return static_cast<std::uint8_t>(id); });
  return to_image(narrow, "mono8", header);
}

}  // namespace lapis::messages
