#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/mapping/model/label_list.hpp"
#include "simulator/core/render/renderer.hpp"

namespace lapis::simulator {

/// Colour, depth (near: bright, from 8 m on nearly black; nothing: black), and classes in their colours, side by side.
geometry::ColorImage side_by_side(const RenderedFrame& frame, const mapping::LabelList& labels);

/// Pictures of equal size in rows, each scaled down to `width_px` and named.
geometry::ColorImage contact_sheet(const std::vector<geometry::ColorImage>& pictures,
                                   const std::vector<std::string>& names, int columns, int width_px);

/// Encoded as PNG, or as JPEG when the name says so. Depth and labels are lossless: use PNG.
/// @throws std::runtime_error naming the file when it cannot be written
void write_image(const std::filesystem::path& file, const geometry::ColorImage& image);
void write_image(const std::filesystem::path& file, const geometry::Image<std::uint16_t>& image);

}  // namespace lapis::simulator
