#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/assets/model.hpp"

namespace lapis::simulator {

/// A glTF 2.0 scene in the frame of its file (y up, metres, if it complies with the specification). The groups of the
/// model are the nodes of the file, with their transforms applied; a node without a name has that of its mesh.
struct GltfModel {
  Model model;
  std::vector<int> parents;                       ///< per group: index of the parent node, or -1
  std::vector<std::string> classes;               ///< per group: extras.class, or empty
  std::vector<std::vector<std::uint8_t>> images;  ///< of visible materials, encoded as in the file; empty: missing
  std::vector<std::string> image_names;           ///< for messages
  std::string file;                               ///< for messages
};

/// Reads geometry and structure of a .gltf or .glb file. Until finish_looks() has run, Material::texture is an index
/// into `images`, and Mesh::colors holds the values of COLOR_0 without conversion. Skins, morph targets, points and
/// lines are left out, and so are materials that are nearly transparent (alphaMode BLEND, alpha below 0.35), as in
/// read_obj().
/// @throws std::runtime_error with one line that names the remedy: for files that are missing, truncated, or
///   inconsistent; for required extensions that are not read (compression, KTX2, ...) and sparse geometry; when the
///   nodes are no tree; for more than 30 million vertices or triangles, or 1 GiB of images.
GltfModel read_gltf(const AssetStore& store, const std::string& name);

/// Decodes the images, and converts vertex colours, which are linear light in glTF, to sRGB. Materials whose images
/// cannot be decoded become grey; one warning covers all of them.
/// @throws std::runtime_error when the textures have more than 2^30 texels.
void finish_looks(GltfModel& scene, int max_texture_px);

}  // namespace lapis::simulator
