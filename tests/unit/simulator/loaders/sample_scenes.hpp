#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "common/geometry/image.hpp"
#include "unit/simulator/assets/asset_files.hpp"

/// Tiny files of every layout that the loaders read. They are seeds of the fuzzers too.
namespace lapis::simulator::test {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

/// What a PLY file is written from.
struct PlySource {
  std::vector<Eigen::Vector3f> positions;
  std::vector<geometry::Rgb8> vertex_colors;  ///< empty: none
  std::vector<std::vector<std::uint32_t>> polygons;
  std::vector<std::string> labels;                      ///< names of int properties of the faces
  std::vector<std::vector<std::int32_t>> label_values;  ///< [label][polygon]
  std::vector<geometry::Rgb8> face_colors;              ///< empty: none
};

Bytes write_ply(const PlySource& source, PlyFormat format);

/// A floor of 2 m x 2 m at z = 0 and a block of 0.4 m x 0.4 m x 0.8 m on it: polygons 0..1 (floor), 2..11 (block).
PlySource floor_and_block();

/// scene_labelled.ply, classes.csv (1 floor, 2 chair), instances.csv (1 the floor, 7 the block).
Files labelled_ply_files(PlyFormat format = PlyFormat::kLittleEndian);
/// ID.house (object 0: floor, 1: chair, 2: none), ID_semantic.ply for ID "m".
Files matterport_files();
/// mesh_semantic.ply and info_semantic.json; quads.
Files replica_files();
/// h.semantic.glb, h.semantic.txt, h.glb: two triangles, one below each half of a texture.
Files hm3d_files();
/// hm3dsem_category_mappings.tsv
Bytes hm3d_mapping();

/// Puts a glTF scene together.
class GltfBuilder {
 public:
  GltfBuilder();
  nlohmann::json root;

  /// An accessor of floats with `width` components. Returns its index.
  std::size_t add_floats(const std::vector<float>& values, std::size_t width);
  std::size_t add_indices(const std::vector<std::uint16_t>& values);
  /// An accessor of any kind over a view of these bytes.
  std::size_t add_accessor(const Bytes& bytes, std::size_t component_type, const std::string& type, std::size_t count,
                           std::size_t stride = 0, bool is_normalized = false);
  std::size_t add_image(const Bytes& bytes);
  /// A texture of the image and a material that shows it. Returns the material's index.
  std::size_t add_textured_material(std::size_t image, const std::string& name = "textured");
  /// A mesh of one primitive. Returns its index.
  std::size_t add_mesh(const nlohmann::json& primitive);
  /// A node that the scene shows. Returns its index.
  std::size_t add_node(const nlohmann::json& node);

  Bytes glb() const;
  /// NAME.gltf and NAME.bin
  Files separate(const std::string& name) const;
  /// A .gltf file with the buffer in a data address.
  Bytes embedded() const;

 private:
  std::size_t add_view(const Bytes& bytes, std::size_t stride);
  Bytes binary_;
};

/// A triangle (0,0,0), (1,0,0), (0,1,0) as a mesh that nodes can show. Returns its index.
std::size_t add_triangle_mesh(GltfBuilder& builder, std::optional<std::size_t> material = std::nullopt);
/// Node "house" with the children "chair" (extras.class chair) and "wall", shifted.
GltfBuilder labelled_gltf();

}  // namespace lapis::simulator::test
