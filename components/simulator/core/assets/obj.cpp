#include "simulator/core/assets/obj.hpp"

#include <array>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "simulator/core/assets/asset_finder.hpp"
#include "simulator/core/assets/image_data.hpp"
#include "simulator/core/assets/mtl.hpp"
#include "simulator/core/assets/text_scan.hpp"

namespace lapis::simulator {
namespace {

constexpr float kLeastOpacity = 0.35F;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

bool has_area(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  const Eigen::Vector3d ab = (b.cast<double>() - a.cast<double>()), ac = (c.cast<double>() - a.cast<double>());
  return ab.cross(ac).squaredNorm() > 0;
}

// A material that `usemtl` names. It is added to the mesh when a triangle first needs it.
struct UsedMaterial {
  MtlMaterial look;
  std::uint32_t plain = kNone;     ///< in Mesh::materials, for faces without texture coordinates
  std::uint32_t textured = kNone;  ///< same, for faces with them

  bool is_visible() const { return look.opacity >= kLeastOpacity; }
};

// Indices into the positions and texture coordinates of the file; kNone: no texture coordinate.
struct Corner {
  std::uint32_t position = kNone;
  std::uint32_t texture = kNone;
};

// Mesh vertices, one per pair of position and texture coordinate. Those of one position form a linked list.
class VertexMerger {
 public:
  std::uint32_t index_of(const Corner& corner) {
    if (first_.size() <= corner.position) first_.resize(corner.position + 1, kNone);
    for (std::uint32_t i = first_[corner.position]; i != kNone; i = vertices_[i].next) {
      if (vertices_[i].corner.texture == corner.texture) return i;
    }
    vertices_.push_back({corner, first_[corner.position]});
    return first_[corner.position] = static_cast<std::uint32_t>(vertices_.size() - 1);
  }

  void write(const std::vector<Eigen::Vector3f>& positions, const std::vector<Eigen::Vector2f>& texture_coordinates,
             Mesh& mesh) const {
    bool is_textured = false;
    for (const auto& [corner, next] : vertices_) {
      mesh.positions.push_back(positions[corner.position]);
      is_textured |= corner.texture != kNone;
    }
    if (!is_textured) return;
    for (const auto& [corner, next] : vertices_) {
      const bool is_bare = corner.texture == kNone;
      mesh.texture_coordinates.push_back(is_bare ? Eigen::Vector2f(0, 0) : texture_coordinates[corner.texture]);
    }
  }

 private:
  struct Vertex {
    Corner corner;
    std::uint32_t next;  ///< next vertex of the same position, or kNone
  };
  std::vector<std::uint32_t> first_;  ///< first vertex of the list, per position
  std::vector<Vertex> vertices_;
};

class ObjReader {
 public:
  ObjReader(const AssetStore& store, const std::string& name, int max_texture_px)
      : store_(store), name_(name), max_texture_px_(max_texture_px), finder_(store, name) {}

  Model read();

 private:
  [[noreturn]] void fail(const std::string& what) const;
  void read_line(std::string_view line);
  void read_position(std::string_view line);
  void read_texture_coordinate(std::string_view line);
  void read_face(std::string_view line);
  Corner read_corner(std::string_view word) const;
  std::uint32_t to_index(std::int64_t number, std::size_t count) const;
  void add_triangle(const std::array<std::uint32_t, 3>& corners, bool has_texture_coordinates);
  void read_materials(std::string_view files);
  bool read_material_file(std::string_view file);
  void use_material(const std::string& material);
  std::uint32_t material_index(bool has_texture_coordinates);
  std::shared_ptr<const TextureImage> texture(const std::string& written);
  std::uint32_t group_index();

  const AssetStore& store_;
  const std::string& name_;
  int max_texture_px_;
  AssetFinder finder_;
  Model model_;
  std::size_t line_ = 0;
  std::vector<Eigen::Vector3f> positions_;
  std::vector<Eigen::Vector2f> texture_coordinates_;
  VertexMerger merger_;
  std::vector<Corner> corners_;  ///< of the face being read
  std::map<std::string, MtlMaterial, std::less<>> library_;
  std::map<std::string, UsedMaterial> used_;
  std::string material_name_;
  UsedMaterial* material_ = nullptr;
  std::map<std::string, std::shared_ptr<const TextureImage>> textures_;
  std::size_t texels_ = 0;
  std::map<std::string, std::uint32_t> groups_;
  std::string group_name_ = "default";
  std::uint32_t group_ = kNone;  ///< index of group_name_ in Model::groups; kNone: not looked up yet
};

Model ObjReader::read() {
  const auto bytes = store_.read(name_);
  const auto refuse = [&](const std::string& what) {
    throw std::runtime_error(store_.description() + ": " + name_ + ": " + what);
  };
  if (!bytes) refuse("no readable file of that name; check the model's name");
  use_material({});
  for (std::string_view text = as_text(*bytes); !text.empty();) {
    ++line_;
    read_line(take_line(text));
  }
  if (model_.mesh.triangles.empty()) refuse("no triangles that can be seen (glass cannot); use another model");
  merger_.write(positions_, texture_coordinates_, model_.mesh);
  return std::move(model_);
}

void ObjReader::fail(const std::string& what) const {
  throw std::runtime_error(store_.description() + ": " + name_ + ": line " + std::to_string(line_) + ": " + what);
}

void ObjReader::read_line(std::string_view line) {
  const std::string_view key = take_word(line);
  if (key == "v") {
    read_position(line);
  } else if (key == "vt") {
    read_texture_coordinate(line);
  } else if (key == "f") {
    read_face(line);
  } else if (key == "usemtl") {
    use_material(std::string(trimmed(line)));
  } else if (key == "mtllib") {
    read_materials(trimmed(line));
  } else if (key == "g" || key == "o") {
    const std::string_view group = trimmed(line);
    group_name_ = group.empty() ? "default" : group;
    group_ = kNone;
  }
}

void ObjReader::read_position(std::string_view line) {
  const auto x = to_float(take_word(line)), y = to_float(take_word(line)), z = to_float(take_word(line));
  if (!x || !y || !z) fail("a vertex needs three finite numbers; export the model again");
  positions_.emplace_back(*x, *y, *z);
}

void ObjReader::read_texture_coordinate(std::string_view line) {
  const auto u = to_float(take_word(line));
  const std::string_view second = take_word(line);  // left out for textures of one dimension
  const auto v = second.empty() ? 0.0F : to_float(second);
  if (!u || !v) fail("a texture coordinate needs finite numbers; export the model again");
  texture_coordinates_.emplace_back(*u, *v);
}

void ObjReader::read_face(std::string_view line) {
  corners_.clear();
  bool has_texture_coordinates = true;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) {
    corners_.push_back(read_corner(word));
    has_texture_coordinates &= corners_.back().texture != kNone;
  }
  if (corners_.size() < 3) return;
  const std::uint32_t first = merger_.index_of(corners_[0]);
  std::uint32_t second = merger_.index_of(corners_[1]);
  for (std::size_t i = 2; i < corners_.size(); ++i) {
    const auto &a = corners_[0].position, &b = corners_[i - 1].position, &c = corners_[i].position;
    const std::uint32_t third = merger_.index_of(corners_[i]);
    if (material_->is_visible() && has_area(positions_[a], positions_[b], positions_[c]))
      add_triangle({first, second, third}, has_texture_coordinates);
    second = third;
  }
}

// Reads "v", "v/vt", "v/vt/vn" or "v//vn".
Corner ObjReader::read_corner(std::string_view word) const {
  Corner corner;
  const char* at = word.data();
  const char* const end = at + word.size();
  const auto take_index = [&](std::size_t count) {
    std::int64_t number = 0;
    const auto [stop, error] = std::from_chars(at, end, number);
    if (error != std::errc() || (stop != end && *stop != '/'))
      fail("'" + std::string(word.substr(0, 40)) + "' is no corner of a face; export the model again");
    at = stop;
    return to_index(number, count);
  };
  corner.position = take_index(positions_.size());
  const bool has_texture = at + 1 < end && at[1] != '/';
  if (!has_texture) return corner;
  ++at;
  corner.texture = take_index(texture_coordinates_.size());
  return corner;
}

// Positive numbers count from 1, negative ones backwards from the last element, which is -1.
std::uint32_t ObjReader::to_index(std::int64_t number, std::size_t count) const {
  const auto size = static_cast<std::int64_t>(count);
  if (number == 0 || number > size || number < -size) {
    fail("a face names vertex or texture coordinate " + std::to_string(number) + " of " + std::to_string(count) +
         "; export the model again");
  }
  return static_cast<std::uint32_t>(number > 0 ? number - 1 : size + number);
}

void ObjReader::add_triangle(const std::array<std::uint32_t, 3>& corners, bool has_texture_coordinates) {
  model_.mesh.triangles.push_back({corners, material_index(has_texture_coordinates), group_index()});
}

// Reads one file whose name may contain blanks, or several files; failing that, the file with the model's name.
void ObjReader::read_materials(std::string_view files) {
  if (read_material_file(files)) return;
  bool is_found = false;
  for (std::string_view rest = files; !rest.empty();) is_found |= read_material_file(take_word(rest));
  if (is_found || read_material_file(std::filesystem::path(name_).stem().string() + ".mtl")) return;
  model_.warnings.push_back(name_ + ": material file '" + std::string(files) + "' not found");
}

bool ObjReader::read_material_file(std::string_view file) {
  const auto found = finder_.file(file);
  if (!found) return false;
  library_.merge(parse_mtl(as_text(found->bytes)));
  return true;
}

void ObjReader::use_material(const std::string& material) {
  const auto [used, is_new] = used_.try_emplace(material);
  material_name_ = material;
  material_ = &used->second;
  if (!is_new) return;
  const auto defined = library_.find(material);
  if (defined != library_.end()) {
    material_->look = defined->second;
  } else if (!material.empty()) {
    model_.warnings.push_back(name_ + ": material '" + material + "' is not defined; grey stands in");
  }
}

std::uint32_t ObjReader::material_index(bool has_texture_coordinates) {
  const bool is_textured = has_texture_coordinates && !material_->look.texture.empty();
  std::uint32_t& index = is_textured ? material_->textured : material_->plain;
  if (index != kNone) return index;
  Material material;
  material.name = material_name_;
  material.color = material_->look.color;
  const auto image = is_textured ? texture(material_->look.texture) : nullptr;
  if (image) {
    material.color = {255, 255, 255};
    material.is_cut_out = has_holes(*image);
  }
  return index = add_material(model_.mesh, std::move(material), image);
}

std::shared_ptr<const TextureImage> ObjReader::texture(const std::string& written) {
  const auto [entry, is_new] = textures_.try_emplace(written);
  if (!is_new) return entry->second;
  const auto found = finder_.image(written);
  if (found) entry->second = decode_texture(found->bytes, max_texture_px_);
  texels_ += entry->second ? entry->second->pixels.size() : 0;
  if (texels_ > kMaxTexels) fail("the textures have more than 1 G texels; shrink them");
  if (!entry->second) {
    model_.warnings.push_back(name_ + ": texture '" + written + "' is missing or no image; a plain colour stands in");
  } else if (found->is_guess) {
    model_.warnings.push_back(name_ + ": texture '" + written + "' is missing; the only image beside the model, '" +
                              found->name + "', stands in");
  }
  return entry->second;
}

std::uint32_t ObjReader::group_index() {
  if (group_ != kNone) return group_;
  const auto [entry, is_new] = groups_.try_emplace(group_name_, static_cast<std::uint32_t>(model_.groups.size()));
  if (is_new) model_.groups.push_back(group_name_);
  return group_ = entry->second;
}

}  // namespace

Model read_obj(const AssetStore& store, const std::string& name, int max_texture_px) {
  return ObjReader(store, name, max_texture_px).read();
}

}  // namespace lapis::simulator
