#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/mapping/model/label_list.hpp"
#include "simulator/core/render/renderer.hpp"

namespace lapis::simulator {

/// Colour, depth (near: bright; 8 m and more: nearly black; none: black), and classes in their colours, side by side.
geometry::ColorImage side_by_side(const RenderedFrame& frame, const mapping::LabelList& labels);

/// Pictures of equal size in rows of `columns`, each scaled to the width `width_px` and captioned with its name.
geometry::ColorImage contact_sheet(const std::vector<geometry::ColorImage>& pictures,
                                   const std::vector<std::string>& names, int columns, int width_px);

/// Writes an image as PNG or JPEG, as the extension of the name says. Depth and labels must be lossless: use PNG.
/// @throws std::runtime_error naming the file when it cannot be written
void write_image(const std::filesystem::path& file, const geometry::ColorImage& image);
void write_image(const std::filesystem::path& file, const geometry::Image<std::uint16_t>& image);

}  // namespace lapis::simulator
