#include "common/messages/compressed_depth.hpp"

#include <cmath>
#include <cstring>
#include <span>

#include "common/images/encoded_image.hpp"
#include "common/messages/camera.hpp"

namespace lapis::messages {
namespace {

using sensor_msgs::msg::Image;

constexpr std::size_t kHeaderBytes = 12;

/// Parameters of the header, for depth in metres.
struct InverseDepth {
  float a = 0.0f;
  float b = 0.0f;
  float metres(std::uint16_t value) const {
    const float depth = a / (static_cast<float>(value) - b);
    return value != 0 && std::isfinite(depth) && depth > 0.0f ? depth : 0.0f;
  }
};

InverseDepth read_parameters(std::span<const std::uint8_t> header) {
  InverseDepth result;
  std::memcpy(&result.a, header.data() + 4, sizeof result.a);
  std::memcpy(&result.b, header.data() + 8, sizeof result.b);
  return result;
}

Image image_of(const std_msgs::msg::Header& header, const geometry::Image<std::uint16_t>& values,
               const std::string& encoding, std::size_t bytes_per_pixel) {
  Image image;
  image.header(header);
  image.width(static_cast<std::uint32_t>(values.width));
  image.height(static_cast<std::uint32_t>(values.height));
  image.encoding(encoding);
  image.step(static_cast<std::uint32_t>(image.width() * bytes_per_pixel));
  image.data().resize(values.pixels.size() * bytes_per_pixel);
  return image;
}

Image depth_in_mm(const std_msgs::msg::Header& header, const geometry::Image<std::uint16_t>& values) {
  Image image = image_of(header, values, "16UC1", sizeof(std::uint16_t));
  std::memcpy(image.data().data(), values.pixels.data(), image.data().size());
  return image;
}

Image depth_in_m(const std_msgs::msg::Header& header, const geometry::Image<std::uint16_t>& values,
                 const InverseDepth& parameters) {
  Image image = image_of(header, values, "32FC1", sizeof(float));
  std::uint8_t* target = image.data().data();
  for (const std::uint16_t value : values.pixels) {
    const float depth = parameters.metres(value);
    std::memcpy(target, &depth, sizeof depth);
    target += sizeof depth;
  }
  return image;
}

}  // namespace

Converted<Image> unpack_depth(const sensor_msgs::msg::CompressedImage& message) {
  using Result = Converted<Image>;
  const std::string& format = message.format();
  const std::string encoding = format.substr(0, format.find(';'));
  const bool is_in_m = encoding == "32FC1";
  if (!is_in_m && encoding != "16UC1" && encoding != "mono16") {
    return Result::refused("format of the compressed image does not begin with 16UC1 or 32FC1");
  }
  if (format.find("rvl") != std::string::npos) return Result::refused("it is packed as RVL: set the driver to png");
  const std::span<const std::uint8_t> bytes(message.data());
  if (bytes.size() < kHeaderBytes) return Result::refused("compressed depth image is damaged");
  const auto png = bytes.subspan(kHeaderBytes);
  const auto size = images::encoded_size(png);
  if (!size) return Result::refused("compressed depth image is not a PNG behind a header of 12 bytes");
  if (size->width > kMostDecodedPixels / size->height) {
    return Result::refused("compressed depth image has more than 2^25 pixels");
  }
  const auto values = images::decode_wide(png);
  if (!values) return Result::refused("compressed depth image is damaged");
  if (is_in_m) return depth_in_m(message.header(), *values, read_parameters(bytes));
  return depth_in_mm(message.header(), *values);
}

}  // namespace lapis::messages
