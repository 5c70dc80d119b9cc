#include "simulator/core/assets/mtl.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "simulator/core/assets/text_scan.hpp"

namespace lapis::simulator {
namespace {

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 1.0F) * 255.0F));
}

void read_color(std::string_view numbers, geometry::Rgb8& color) {
  const auto r = to_float(take_word(numbers)), g = to_float(take_word(numbers)), b = to_float(take_word(numbers));
  if (r && g && b) color = {to_byte(*r), to_byte(*g), to_byte(*b)};
}

// Greatest number of words after an option of a texture map; -o, -s and -t may have fewer.
std::size_t option_length(std::string_view option) {
  if (option == "-o" || option == "-s" || option == "-t") return 3;
  return option == "-mm" ? 2 : 1;
}

// The file name after the options; it may contain blanks.
std::string_view texture_name(std::string_view text) {
  text = trimmed(text);
  while (text.starts_with('-')) {
    const std::size_t count = option_length(take_word(text));
    for (std::size_t i = 0; i < count; ++i) {
      std::string_view rest = text;
      const std::string_view word = take_word(rest);
      if (count > 1 && !to_float(word)) break;
      text = rest;
    }
    text = trimmed(text);
  }
  return text;
}

}  // namespace

std::map<std::string, MtlMaterial, std::less<>> parse_mtl(std::string_view text) {
  std::map<std::string, MtlMaterial, std::less<>> materials;
  MtlMaterial* current = nullptr;
  while (!text.empty()) {
    std::string_view line = take_line(text);
    const std::string_view key = take_word(line);
    if (key == "newmtl") current = &materials[std::string(trimmed(line))];
    if (current == nullptr) continue;
    if (key == "Kd") read_color(line, current->color);
    if (key == "d") current->opacity = to_float(take_word(line)).value_or(current->opacity);
    if (key == "Tr") current->opacity = 1.0F - to_float(take_word(line)).value_or(1.0F - current->opacity);
    if (key == "map_Kd") current->texture = texture_name(line);
  }
  return materials;
}

}  // namespace lapis::simulator
