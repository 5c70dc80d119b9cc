#include "simulator/core/loaders/hm3d.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "simulator/core/assets/image_data.hpp"
#include "simulator/core/assets/text_scan.hpp"
#include "simulator/core/loaders/csv_table.hpp"
#include "simulator/core/loaders/gltf.hpp"
#include "simulator/core/loaders/scene_assembly.hpp"

namespace lapis::simulator {
namespace {

using Instances = std::map<std::uint32_t, Hm3dInstance>;
using Mapping = std::optional<std::map<std::string, std::string>>;

constexpr int kAnySize = std::numeric_limits<int>::max();
constexpr std::uint32_t kNoColor = std::numeric_limits<std::uint32_t>::max();

std::optional<std::uint32_t> parse_color(std::string_view text) {
  std::uint32_t color = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), color, 16);
  if (text.size() != 6 || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) return std::nullopt;
  return color;
}

std::uint32_t code(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  return std::uint32_t{r} << 16 | std::uint32_t{g} << 8 | b;
}

// The texel at a texture coordinate, without filtering; textures repeat.
std::uint32_t texel(const TextureImage& texture, const Eigen::Vector2f& at) {
  if (!at.allFinite()) return kNoColor;
  const auto index = [](float coordinate, int size) {
    const float fraction = coordinate - std::floor(coordinate);
    return std::min(static_cast<int>(fraction * static_cast<float>(size)), size - 1);
  };
  const Rgba8& t = texture(index(at.x(), texture.width), texture.height - 1 - index(at.y(), texture.height));
  return code(t.r, t.g, t.b);
}

// The most frequent colour; among equally frequent ones, the first.
template <std::size_t Count>
std::uint32_t most_frequent(const std::array<std::uint32_t, Count>& colors) {
  return *std::max_element(colors.begin(), colors.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::count(colors.begin(), colors.end(), a) < std::count(colors.begin(), colors.end(), b);
  });
}

// Samples the texture at seven points, in barycentric coordinates: the centroid first, then three points towards the
// corners, and three towards the edges.
std::uint32_t textured_color(const Mesh& mesh, const Triangle& triangle, const TextureImage& texture) {
  static const std::array<Eigen::Vector3f, 7> kPoints{
      Eigen::Vector3f(1, 1, 1) / 3, {0.6F, 0.2F, 0.2F},   {0.2F, 0.6F, 0.2F},  {0.2F, 0.2F, 0.6F},
      {0.45F, 0.45F, 0.1F},         {0.45F, 0.1F, 0.45F}, {0.1F, 0.45F, 0.45F}};
  std::array<std::uint32_t, kPoints.size()> colors{};
  for (std::size_t i = 0; i < kPoints.size(); ++i) {
    Eigen::Vector2f at(0, 0);
    for (std::size_t k = 0; k < 3; ++k)
      at += kPoints[i][static_cast<int>(k)] * mesh.texture_coordinates[triangle.vertices[k]];
    colors[i] = texel(texture, at);
  }
  return most_frequent(colors);
}

// Colours of all triangles; kNoColor where there is none. Textures are decoded one at a time, because they are large.
std::vector<std::uint32_t> triangle_colors(const GltfModel& scene) {
  const Mesh& mesh = scene.model.mesh;
  std::vector<std::uint32_t> colors(mesh.triangles.size(), kNoColor);
  std::vector<std::vector<std::size_t>> textured(scene.images.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& triangle = mesh.triangles[i];
    const int image = mesh.materials[triangle.material].texture;
    if (image >= 0 && !mesh.texture_coordinates.empty()) {
      textured[static_cast<std::size_t>(image)].push_back(i);
    } else if (!mesh.colors.empty()) {
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& c = mesh.colors[triangle.vertices[k]];
        corners[k] = code(c.r, c.g, c.b);
      }
      colors[i] = most_frequent(corners);
    }
  }
  for (std::size_t image = 0; image < textured.size(); ++image) {
    if (textured[image].empty()) continue;
    const auto texture = decode_texture(scene.images[image], kAnySize);
    if (!texture) {
      throw std::runtime_error(scene.file + ": texture '" + scene.image_names[image] +
                               "' is no PNG; take the annotations that are not in the Basis format");
    }
    for (const std::size_t i : textured[image]) colors[i] = textured_color(mesh, mesh.triangles[i], *texture);
  }
  return colors;
}

bool have_same_triangles(const Mesh& a, const Mesh& b) {
  constexpr float kTolerance_m = 1e-3F;
  const auto is_same = [&](const Triangle& s, const Triangle& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f difference = a.positions[s.vertices[k]] - b.positions[t.vertices[k]];
      if (!(difference.cwiseAbs().maxCoeff() <= kTolerance_m)) return false;
    }
    return true;
  };
  return std::equal(a.triangles.begin(), a.triangles.end(), b.triangles.begin(), b.triangles.end(), is_same);
}

class Hm3dLoader {
 public:
  Hm3dLoader(const AssetStore& store, const std::string& id, const Mapping& mapping, const LoadOptions& options)
      : store_(store), id_(id), mapping_(mapping), options_(options), file_(full_name(store, id + ".semantic.glb")) {}
  Scene load();

 private:
  std::vector<std::uint32_t> label(const Instances& known, const std::vector<std::uint32_t>& colors);
  std::string class_of(const Hm3dInstance& instance);
  void choose_looks(GltfModel& semantic, const std::vector<std::uint32_t>& colors);
  static void show_instances(Mesh& mesh, const std::vector<std::uint32_t>& colors);

  const AssetStore& store_;
  const std::string& id_;
  const Mapping& mapping_;
  const LoadOptions& options_;
  std::string file_;
  std::set<std::string> unmapped_;
  Scene scene_;
};

Scene Hm3dLoader::load() {
  const std::string list = id_ + ".semantic.txt";
  const auto text = read_required(store_, list);
  const Instances known = parse_hm3d_instances(as_text(text), full_name(store_, list));
  GltfModel semantic = read_gltf(store_, id_ + ".semantic.glb");
  const auto colors = triangle_colors(semantic);
  const auto parts = label(known, colors);
  scene_.is_lit = false;
  choose_looks(semantic, colors);
  for (std::size_t i = 0; i < parts.size(); ++i) scene_.mesh.triangles[i].part = parts[i];
  finish_scene(scene_, file_);
  return std::move(scene_);
}

// Returns the instance of every triangle.
std::vector<std::uint32_t> Hm3dLoader::label(const Instances& known, const std::vector<std::uint32_t>& colors) {
  std::set<std::string> names;
  for (const auto& [color, instance] : known) names.insert(class_of(instance));
  ClassNames classes(mapping_ ? options_.labels : mapping::LabelList(), names);
  InstanceList instances(file_);
  std::map<std::uint32_t, std::uint32_t> index_of;
  for (const auto& [color, instance] : known)
    index_of[color] = instances.add(instance.id, classes.id_of(class_of(instance)), instance.category);
  std::vector<std::uint32_t> parts;
  for (const std::uint32_t color : colors) {
    const auto index = index_of.find(color);
    parts.push_back(index == index_of.end() ? instances.unlabelled() : index->second);
  }
  scene_.labels = classes.labels();
  scene_.instances = instances.take();
  if (const auto warning = classes.warning()) scene_.warnings.push_back(file_ + ": " + *warning);
  if (!mapping_) {
    scene_.warnings.push_back(file_ +
                              ": there is no hm3dsem_category_mappings.tsv in the folder or the two above it; the raw "
                              "categories are the classes");
  }
  if (!unmapped_.empty()) {
    scene_.warnings.push_back(file_ + ": " + std::to_string(unmapped_.size()) +
                              " categories are not in hm3dsem_category_mappings.tsv, '" + *unmapped_.begin() +
                              "' for one; what belongs to them is unlabelled");
  }
  return parts;
}

std::string Hm3dLoader::class_of(const Hm3dInstance& instance) {
  if (!mapping_) return instance.category;
  const auto found = mapping_->find(instance.category);
  if (found != mapping_->end()) return found->second;
  unmapped_.insert(instance.category);
  return {};
}

void Hm3dLoader::choose_looks(GltfModel& semantic, const std::vector<std::uint32_t>& colors) {
  if (store_.read(id_ + ".glb")) {
    GltfModel looks = read_gltf(store_, id_ + ".glb");
    if (have_same_triangles(looks.model.mesh, semantic.model.mesh)) {
      finish_looks(looks, options_.max_texture_px);
      scene_.mesh = std::move(looks.model.mesh);
      scene_.warnings.insert(scene_.warnings.end(), looks.model.warnings.begin(), looks.model.warnings.end());
      return;
    }
  }
  scene_.warnings.push_back(file_ + ": no " + id_ +
                            ".glb with the same triangles in the same order (.basis.glb is not read); the colours of "
                            "the instances are shown");
  show_instances(semantic.model.mesh, colors);
  scene_.mesh = std::move(semantic.model.mesh);
}

// Replaces the textures by one plain material per colour.
void Hm3dLoader::show_instances(Mesh& mesh, const std::vector<std::uint32_t>& colors) {
  mesh.colors.clear();
  mesh.texture_coordinates.clear();
  mesh.materials.clear();
  std::map<std::uint32_t, std::uint32_t> material_of;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const std::uint32_t c = colors[i] == kNoColor ? 0xA0A0A0 : colors[i];
    const auto [material, is_new] = material_of.try_emplace(c, 0);
    if (is_new) {
      Material plain;
      plain.color = {static_cast<std::uint8_t>(c >> 16), static_cast<std::uint8_t>(c >> 8 & 0xFF),
                     static_cast<std::uint8_t>(c & 0xFF)};
      material->second = add_material(mesh, std::move(plain), nullptr);
    }
    mesh.triangles[i].material = material->second;
  }
}

}  // namespace

Instances parse_hm3d_instances(std::string_view text, const std::string& file) {
  constexpr std::string_view kTitle = "HM3D Semantic Annotations";
  if (take_line(text).find(kTitle) == std::string_view::npos) {
    throw std::runtime_error(file + ": line 1: there is no '" + std::string(kTitle) + "'; download the file again");
  }
  Instances result;
  for (std::size_t line = 2; !text.empty(); ++line) {
    const std::string_view content = trimmed(take_line(text));
    if (content.empty()) continue;
    const auto fields = split_fields(content, ',');
    const auto id = to_number<std::int64_t>(fields[0]);
    const auto color = parse_color(fields.size() > 1 ? fields[1] : "");
    const std::string place = file + ": line " + std::to_string(line);
    if (!id || !color || fields.size() < 3) {
      throw std::runtime_error(place + ": must be id,RRGGBB,\"category\",region; download the file again");
    }
    if (!result.emplace(*color, Hm3dInstance{*id, std::string(trimmed(fields[2]))}).second) {
      throw std::runtime_error(place + ": the colour " + fields[1] + " occurs twice; download the file again");
    }
  }
  return result;
}

std::map<std::string, std::string> parse_hm3d_mapping(std::string_view text, const std::string& file) {
  const CsvTable table(text, '\t', file);
  if (!table.has("raw_category") || !table.has("mpcat40")) {
    throw std::runtime_error(file + ": line 1: needs the columns raw_category and mpcat40; download the file again");
  }
  std::map<std::string, std::string> result;
  for (const auto& row : table.rows())
    result.emplace(trimmed(table.at(row, "raw_category")), trimmed(table.at(row, "mpcat40")));
  return result;
}

Scene load_hm3d(const AssetStore& store, const std::string& id, const Mapping& mapping, const LoadOptions& options) {
  return Hm3dLoader(store, id, mapping, options).load();
}

}  // namespace lapis::simulator
