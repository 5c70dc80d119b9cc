#pragma once

#include <string>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/assets/model.hpp"

namespace lapis::simulator {

/// Reads a Wavefront OBJ file with its MTL files and textures from a store. Polygons are split into triangle fans;
/// normals are ignored; vertices are merged per pair of position and texture coordinate; triangles without area are
/// dropped. Materials that are nearly transparent (d < 0.35) are left out, as glass is invisible to depth cameras; the
/// vertices of their faces stay, so that bounds() is that of the whole model. A texture replaces the material's colour
/// (many exporters leave an arbitrary grey there); a face without texture coordinates shows the colour. Textures keep
/// at most `max_texture_px` on their longer side. Both `g` and `o` begin a group, the last one counts.
/// @throws std::runtime_error naming store and file for files that are missing, hold no triangles, name vertices that
///   do not exist, or hold numbers that are not finite. A texture or material that is missing is a warning.
Model read_obj(const AssetStore& store, const std::string& name, int max_texture_px = 512);

}  // namespace lapis::simulator
