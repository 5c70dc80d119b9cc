#include "simulator/core/loaders/gltf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "simulator/core/assets/image_data.hpp"
#include "simulator/core/loaders/gltf_file.hpp"
#include "simulator/core/loaders/json_file.hpp"

namespace lapis::simulator {
namespace {

using nlohmann::json;

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr double kLeastOpacity = 0.35;
// Many nodes may show one mesh: without a limit, a small file could demand any amount of memory.
constexpr std::size_t kMostElements = 30'000'000;
constexpr std::size_t kMostImageBytes = std::size_t{1} << 30U;  // of all visible images, encoded as in the file

// Encodes linear light as sRGB (IEC 61966-2-1), from 0..1 to 0..255.
std::uint8_t to_srgb(double linear) {
  const double v = std::clamp(linear, 0.0, 1.0);
  const double encoded = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(encoded * 255));
}

std::uint8_t to_byte(float fraction) {  // 0 for NaN
  return fraction > 0 ? static_cast<std::uint8_t>(std::lround(std::min(fraction, 1.0F) * 255)) : std::uint8_t{0};
}

// Corners of the triangles of a primitive [glTF 2.0, section 3.7.2.1].
std::vector<std::array<std::uint32_t, 3>> to_triangles(const std::vector<std::uint32_t>& indices, std::size_t mode) {
  constexpr std::size_t kTriangles = 4, kStrip = 5, kFan = 6;
  std::vector<std::array<std::uint32_t, 3>> result;
  for (std::size_t i = 0; i + 2 < indices.size(); i += mode == kTriangles ? 3 : 1) {
    if (mode == kTriangles) {
      result.push_back({indices[i], indices[i + 1], indices[i + 2]});
    } else if (mode == kStrip) {
      result.push_back({indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
    } else if (mode == kFan) {
      result.push_back({indices[0], indices[i + 1], indices[i + 2]});
    }
  }
  return result;
}

// Walks upwards from every node, as far as no earlier walk has been.
bool has_cycle(const std::vector<int>& parents) {
  std::vector<int> first_walk(parents.size(), -1);
  for (std::size_t i = 0; i < parents.size(); ++i) {
    for (int node = static_cast<int>(i); node >= 0; node = parents[static_cast<std::size_t>(node)]) {
      int& walk = first_walk[static_cast<std::size_t>(node)];
      if (walk == static_cast<int>(i)) return true;
      if (walk >= 0) break;
      walk = static_cast<int>(i);
    }
  }
  return false;
}

class GltfReader {
 public:
  GltfReader(const AssetStore& store, const std::string& name) : file_(store, name) {}
  GltfModel read();

 private:
  struct Visit {
    std::size_t node = 0;
    Eigen::Affine3d T_scene_parent;
  };

  void refuse_extensions() const;
  void read_nodes();
  std::vector<std::size_t> root_nodes() const;
  void link_children();
  Eigen::Affine3d transform(const json& node) const;
  void add_mesh(std::size_t mesh, const Eigen::Affine3d& T, std::uint32_t node);
  void add_primitive(const json& primitive, const Eigen::Affine3d& T, std::uint32_t node);
  void add_vertices(const json& attributes, std::size_t texture_set, const Eigen::Affine3d& T);
  std::vector<geometry::Rgb8> read_colors(std::size_t accessor) const;
  std::optional<std::uint32_t> material(std::size_t index);
  std::optional<std::uint32_t> make_material(const json& source);
  int texture_image(const json& reference);
  void add_image(std::size_t index);

  GltfFile file_;
  GltfModel scene_;
  std::map<std::size_t, std::optional<std::uint32_t>> materials_;  ///< by index in the file; nothing: not shown
  std::map<std::size_t, std::size_t> images_;                      ///< index in the file -> GltfModel::images
  std::size_t image_bytes_ = 0;
};

GltfModel GltfReader::read() {
  scene_.file = file_.description();
  refuse_extensions();
  read_nodes();
  std::vector<Visit> stack;
  for (const std::size_t root : root_nodes()) stack.push_back({root, Eigen::Affine3d::Identity()});
  std::vector<bool> is_visited(scene_.parents.size(), false);
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const json& node = file_.item("nodes", visit.node);
    if (is_visited[visit.node]) file_.fail("node " + std::to_string(visit.node) + " is there twice; export again");
    is_visited[visit.node] = true;
    const Eigen::Affine3d T = visit.T_scene_parent * transform(node);
    const std::size_t mesh = index_member(node, "mesh", scene_.file, kNone);
    if (mesh != kNone) add_mesh(mesh, T, static_cast<std::uint32_t>(visit.node));
    for (const auto& child : array_member(node, "children", scene_.file))
      stack.push_back({child.get<std::size_t>(), T});
  }
  if (scene_.model.mesh.triangles.empty()) file_.fail("there are no visible triangles; export the scene again");
  return std::move(scene_);
}

// A reader must support all extensions that a file requires, or refuse the file [section 3.12].
void GltfReader::refuse_extensions() const {
  constexpr std::array<std::string_view, 2> kRead{"KHR_materials_unlit", "KHR_mesh_quantization"};
  for (const auto& extension : array_member(file_.root(), "extensionsRequired", scene_.file)) {
    if (!extension.is_string()) file_.fail("'extensionsRequired' must be a list of names; export the file again");
    const std::string name = extension.get<std::string>().substr(0, 60);
    if (std::find(kRead.begin(), kRead.end(), name) != kRead.end()) continue;
    std::string what = "the file requires " + name, remedy = "export without it";
    if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression") {
      what = "the geometry is compressed (" + name + ")", remedy = "export without compression";
    } else if (name == "KHR_texture_basisu" || name == "GOOGLE_texture_basis") {
      what = "the textures are compressed (KTX2: " + name + ")", remedy = "export them as PNG or JPEG";
    }
    what += ", which is not read; ";
    what += remedy;
    what += " (required extensions that are read: KHR_materials_unlit, KHR_mesh_quantization)";
    file_.fail(what);
  }
}

void GltfReader::read_nodes() {
  for (const auto& node : array_member(file_.root(), "nodes", scene_.file)) {
    std::string name = text_member(node, "name", scene_.file);
    const std::size_t mesh = index_member(node, "mesh", scene_.file, kNone);
    if (name.empty() && mesh != kNone) name = text_member(file_.item("meshes", mesh), "name", scene_.file);
    if (name.empty()) name = "node " + std::to_string(scene_.model.groups.size());
    scene_.model.groups.push_back(std::move(name));
    scene_.classes.push_back(text_member(member(node, "extras"), "class", scene_.file));
    scene_.parents.push_back(-1);
  }
  link_children();
}

void GltfReader::link_children() {
  const auto& nodes = array_member(file_.root(), "nodes", scene_.file);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const auto& child : array_member(nodes[i], "children", scene_.file)) {
      const bool is_node = child.is_number_unsigned() && child.get<std::size_t>() < nodes.size();
      if (!is_node || scene_.parents[child.get<std::size_t>()] >= 0) {
        file_.fail("the children of node " + std::to_string(i) + " make no tree; export the scene again");
      }
      scene_.parents[child.get<std::size_t>()] = static_cast<int>(i);
    }
  }
  if (has_cycle(scene_.parents)) file_.fail("the nodes make no tree; export the scene again");
}

// Root nodes of the default scene; in a file without scenes, the nodes that have no parent.
std::vector<std::size_t> GltfReader::root_nodes() const {
  std::vector<std::size_t> roots;
  if (array_member(file_.root(), "scenes", scene_.file).empty()) {
    for (std::size_t i = 0; i < scene_.parents.size(); ++i) {
      if (scene_.parents[i] < 0) roots.push_back(i);
    }
    return roots;
  }
  const auto& scene = file_.item("scenes", index_member(file_.root(), "scene", scene_.file, 0));
  for (const auto& node : array_member(scene, "nodes", scene_.file)) {
    if (!node.is_number_unsigned() || node.get<std::size_t>() >= scene_.parents.size()) {
      file_.fail("the scene names a node that is not there; export the scene again");
    }
    roots.push_back(node.get<std::size_t>());
  }
  return roots;
}

// Transform of a node: a matrix (column by column), or T * R * S [section 3.5.3].
Eigen::Affine3d GltfReader::transform(const json& node) const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  read_numbers(node, "matrix", scene_.file, {matrix.data(), 16});
  std::array<double, 3> t{0, 0, 0}, s{1, 1, 1};
  std::array<double, 4> q{0, 0, 0, 1};
  read_numbers(node, "translation", scene_.file, t);
  read_numbers(node, "rotation", scene_.file, q);
  read_numbers(node, "scale", scene_.file, s);
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  Eigen::Affine3d T(matrix);
  return T * Eigen::Translation3d(t[0], t[1], t[2]) * rotation.normalized() * Eigen::Scaling(s[0], s[1], s[2]);
}

void GltfReader::add_mesh(std::size_t mesh, const Eigen::Affine3d& T, std::uint32_t node) {
  for (const auto& primitive : array_member(file_.item("meshes", mesh), "primitives", scene_.file)) {
    add_primitive(primitive, T, node);
  }
}

void GltfReader::add_primitive(const json& primitive, const Eigen::Affine3d& T, std::uint32_t node) {
  const std::size_t mode = index_member(primitive, "mode", scene_.file, 4);
  const json& attributes = member(primitive, "attributes");
  if (mode < 4 || mode > 6 || member(attributes, "POSITION").is_null()) return;
  const std::size_t material_index = index_member(primitive, "material", scene_.file, kNone);
  const auto look = material(material_index);
  if (!look) return;
  Mesh& mesh = scene_.model.mesh;
  const std::size_t first = mesh.positions.size();
  std::size_t texture_set = 0;
  if (material_index != kNone) {
    const json& reference =
        member(member(file_.item("materials", material_index), "pbrMetallicRoughness"), "baseColorTexture");
    texture_set = index_member(reference, "texCoord", scene_.file, 0);
  }
  add_vertices(attributes, texture_set, T);
  const std::size_t added = mesh.positions.size() - first;
  std::vector<std::uint32_t> indices;
  if (member(primitive, "indices").is_null()) {
    for (std::uint32_t i = 0; i < added; ++i) indices.push_back(i);
  } else {
    indices = file_.indices(index_member(primitive, "indices", scene_.file, kNone));
  }
  if (std::any_of(indices.begin(), indices.end(), [&](std::uint32_t i) { return i >= added; })) {
    file_.fail("a triangle names a vertex that is not there; export the scene again");
  }
  const auto offset = static_cast<std::uint32_t>(first);
  for (const auto& [a, b, c] : to_triangles(indices, mode))
    mesh.triangles.push_back({{a + offset, b + offset, c + offset}, *look, node});
  if (mesh.triangles.size() > kMostElements) file_.fail("there are more than 30 million triangles; split the scene");
}

void GltfReader::add_vertices(const json& attributes, std::size_t texture_set, const Eigen::Affine3d& T) {
  Mesh& mesh = scene_.model.mesh;
  const std::size_t first = mesh.positions.size();
  for (const auto& p : file_.vectors<3>(index_member(attributes, "POSITION", scene_.file, kNone)))
    mesh.positions.emplace_back((T * Eigen::Vector3d(p[0], p[1], p[2])).cast<float>());
  const std::size_t vertices = mesh.positions.size();
  if (vertices > kMostElements) file_.fail("there are more than 30 million vertices; split the scene");
  const std::size_t coordinates =
      index_member(attributes, "TEXCOORD_" + std::to_string(texture_set), scene_.file, kNone);
  if (coordinates != kNone) {
    mesh.texture_coordinates.resize(first, Eigen::Vector2f::Zero());
    for (const auto& uv : file_.vectors<2>(coordinates)) mesh.texture_coordinates.emplace_back(uv[0], 1 - uv[1]);
  }
  const std::size_t colors = index_member(attributes, "COLOR_0", scene_.file, kNone);
  if (colors != kNone) {
    mesh.colors.resize(first, {255, 255, 255});
    const auto added = read_colors(colors);
    mesh.colors.insert(mesh.colors.end(), added.begin(), added.end());
  }
  const bool is_consistent = (coordinates == kNone || mesh.texture_coordinates.size() == vertices) &&
                             (colors == kNone || mesh.colors.size() == vertices);
  if (!is_consistent) file_.fail("a mesh has fewer or more texture coordinates or colours than vertices; export again");
  if (!mesh.texture_coordinates.empty()) mesh.texture_coordinates.resize(vertices, Eigen::Vector2f::Zero());
  if (!mesh.colors.empty()) mesh.colors.resize(vertices, {255, 255, 255});
}

std::vector<geometry::Rgb8> GltfReader::read_colors(std::size_t accessor) const {
  std::vector<geometry::Rgb8> result;
  const auto add = [&](const auto& colors) {
    for (const auto& c : colors) result.push_back({to_byte(c[0]), to_byte(c[1]), to_byte(c[2])});
  };
  if (text_member(file_.item("accessors", accessor), "type", scene_.file) == "VEC4") {
    add(file_.vectors<4>(accessor));
  } else {
    add(file_.vectors<3>(accessor));
  }
  return result;
}

std::optional<std::uint32_t> GltfReader::material(std::size_t index) {
  static const json kDefault;  // an lvalue, so that ?: copies nothing: copies of deeply nested values fail
  const auto [entry, is_new] = materials_.try_emplace(index);
  if (is_new) entry->second = make_material(index == kNone ? kDefault : file_.item("materials", index));
  return entry->second;
}

std::optional<std::uint32_t> GltfReader::make_material(const json& source) {
  const json& surface = member(source, "pbrMetallicRoughness");
  std::array<double, 4> color{1, 1, 1, 1};  // linear
  read_numbers(surface, "baseColorFactor", scene_.file, color);
  const std::string alpha = text_member(source, "alphaMode", scene_.file, "OPAQUE");
  if (alpha == "BLEND" && color[3] < kLeastOpacity) return std::nullopt;
  Material result;
  result.name = text_member(source, "name", scene_.file);
  result.color = {to_srgb(color[0]), to_srgb(color[1]), to_srgb(color[2])};
  result.texture = texture_image(member(surface, "baseColorTexture"));
  result.is_cut_out = alpha != "OPAQUE";
  result.is_emissive = !member(member(source, "extensions"), "KHR_materials_unlit").is_null();
  scene_.model.mesh.materials.push_back(std::move(result));
  return static_cast<std::uint32_t>(scene_.model.mesh.materials.size() - 1);
}

// Index in GltfModel::images of the image that a texture shows; -1: none. Textures in other formats than PNG and JPEG
// may name it in an extension.
int GltfReader::texture_image(const json& reference) {
  if (reference.is_null()) return -1;
  const json& texture = file_.item("textures", index_member(reference, "index", scene_.file, kNone));
  std::size_t image = index_member(texture, "source", scene_.file, kNone);
  const json& extensions = member(texture, "extensions");
  for (const char* extension : {"KHR_texture_basisu", "GOOGLE_texture_basis", "EXT_texture_webp"}) {
    if (image == kNone) image = index_member(member(extensions, extension), "source", scene_.file, kNone);
  }
  const auto [entry, is_new] = images_.try_emplace(image, scene_.images.size());
  if (is_new) add_image(image);
  return static_cast<int>(entry->second);
}

void GltfReader::add_image(std::size_t index) {
  std::string name = "a texture without PNG or JPEG";
  std::vector<std::uint8_t> bytes;
  if (index != kNone) {
    name = text_member(file_.item("images", index), "uri", scene_.file).substr(0, 80);
    if (name.empty() || name.rfind("data:", 0) == 0) name = "image " + std::to_string(index);
    bytes = file_.image(index);
  }
  image_bytes_ += bytes.size();
  if (image_bytes_ > kMostImageBytes) file_.fail("the images have more than 1 GiB; shrink them, or split the scene");
  scene_.images.push_back(std::move(bytes));
  scene_.image_names.push_back(std::move(name));
}

// True for data that begin with the magic number of KTX 2 or of .basis files.
bool is_basis(const std::vector<std::uint8_t>& bytes) {
  constexpr std::array<std::uint8_t, 7> kKtx2{0xAB, 'K', 'T', 'X', ' ', '2', '0'};
  constexpr std::array<std::uint8_t, 2> kBasis{'s', 'B'};
  const auto starts_with = [&](const auto& magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  return starts_with(kKtx2) || starts_with(kBasis);
}

// Decodes the images. Returns the index of the texture of each image, or -1.
std::vector<int> decode_images(GltfModel& scene, int max_texture_px) {
  Mesh& mesh = scene.model.mesh;
  std::vector<int> texture_of(scene.images.size(), -1);
  std::vector<std::string> unreadable;
  std::size_t basis = 0, texels = 0;
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    if (auto texture = decode_texture(scene.images[i], max_texture_px)) {
      texels += texture->pixels.size();
      if (texels > kMaxTexels) {
        throw std::runtime_error(scene.file + ": the textures have more than 1 G texels; shrink them, or split it");
      }
      texture_of[i] = static_cast<int>(mesh.textures.size());
      mesh.textures.push_back(std::move(texture));
    } else {
      unreadable.push_back(scene.image_names[i]);
      if (is_basis(scene.images[i])) ++basis;
    }
    scene.images[i] = {};
  }
  if (!unreadable.empty()) {
    std::string what = scene.file + ": " + std::to_string(unreadable.size()) + " textures ('" + unreadable.front() +
                       "' for one) are missing or no PNG or JPEG";
    if (basis > 0) what += " (" + std::to_string(basis) + " of them are in the Basis format, KTX2)";
    scene.model.warnings.push_back(what + "; grey stands in; put them there, or convert them to PNG");
  }
  return texture_of;
}

}  // namespace

GltfModel read_gltf(const AssetStore& store, const std::string& name) { return GltfReader(store, name).read(); }

void finish_looks(GltfModel& scene, int max_texture_px) {
  constexpr geometry::Rgb8 kGrey{160, 160, 160};
  Mesh& mesh = scene.model.mesh;
  const std::vector<int> texture_of = decode_images(scene, max_texture_px);
  for (auto& material : mesh.materials) {
    const int image = material.texture;
    if (image >= 0) material.texture = texture_of[static_cast<std::size_t>(image)];
    const bool has_texture = material.texture >= 0;
    if (image >= 0 && !has_texture) material.color = kGrey;
    material.is_cut_out &= has_texture && has_holes(*mesh.textures[static_cast<std::size_t>(material.texture)]);
  }
  std::array<std::uint8_t, 256> srgb{};
  for (std::size_t i = 0; i < srgb.size(); ++i) srgb[i] = to_srgb(static_cast<double>(i) / 255);
  for (auto& color : mesh.colors) color = {srgb[color.r], srgb[color.g], srgb[color.b]};
  scene.images.clear();
}

}  // namespace lapis::simulator
