#pragma once

#include <string>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/assets/model.hpp"

namespace lapis::simulator {

/// Reads a Wavefront OBJ file with its MTL files and textures from a store. Polygons are split into triangle fans;
/// normals are ignored; each pair of position and texture coordinate becomes one vertex; triangles without area are
/// dropped. Faces of nearly transparent materials (d < 0.35) are left out, as glass is invisible to depth cameras;
/// their vertices stay, so that bounds() encloses the whole model. A texture replaces the material's colour (many
/// exporters leave an arbitrary grey there); a face without texture coordinates shows the colour. Textures are shrunk
/// to at most `max_texture_px` on their longer side. Both `g` and `o` begin a group; the last one counts.
/// @throws std::runtime_error naming store and file for files that are missing, hold no triangles, name vertices that
///   do not exist, or hold numbers that are not finite. A texture or material that is missing is a warning.
Model read_obj(const AssetStore& store, const std::string& name, int max_texture_px = 512);

}  // namespace lapis::simulator
