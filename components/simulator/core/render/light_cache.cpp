#include "simulator/core/render/light_cache.hpp"

#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include "common/files/atomic_file.hpp"
#include "common/files/crc32.hpp"
#include "common/files/kept_files.hpp"

namespace lapis::simulator {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtension = ".light";
constexpr std::size_t kChecksumBytes = 4;
/// Version of bake_light() and of its ray caster: has to be raised when either gives other light for the same scene.
constexpr std::uint64_t kBakeVersion = 1;
constexpr std::uintmax_t kKept_bytes = 256U << 20U;  // about 70 furnished scenes

/// FNV-1a over words of eight bytes.
class Hash {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* p = static_cast<const std::uint8_t*>(data);
    for (; bytes >= 8; bytes -= 8, p += 8) mix(p, 8);
    if (bytes > 0) mix(p, bytes);
  }
  template <class Value>
  void add(const std::vector<Value>& values) {
    add(values.data(), values.size() * sizeof(Value));
  }
  void add(const std::string& text) { add(text.data(), text.size()); }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void add(Number number) { add(&number, sizeof number); }
  std::uint64_t value() const { return value_; }

 private:
  void mix(const std::uint8_t* p, std::size_t bytes) {
    std::uint64_t word = bytes;
    std::memcpy(&word, p, bytes);
    value_ = (value_ ^ word) * 0x100000001B3ULL;
    value_ ^= value_ >> 32U;
  }
  std::uint64_t value_ = 0xCBF29CE484222325ULL;
};

void add_geometry(Hash& hash, const Scene& scene) {
  hash.add(scene.mesh.positions);
  hash.add(scene.mesh.triangles);
  for (const auto& lamp : scene.lamps) {
    hash.add(lamp.position.data(), sizeof(float) * 3);
    hash.add(lamp.intensity);
  }
}

void add_holes(Hash& hash, const Scene& scene) {
  for (std::size_t i = 0; i < scene.mesh.materials.size(); ++i) {
    const Material& material = scene.mesh.materials[i];
    if (!material.is_cut_out || material.texture < 0) continue;
    const TextureImage& texture = *scene.mesh.textures[static_cast<std::size_t>(material.texture)];
    hash.add(i);
    hash.add(texture.width);
    hash.add(texture.pixels);
  }
  hash.add(scene.mesh.texture_coordinates);
}

/// Adds what a run takes from a scene besides its appearance.
void add_plan(Hash& hash, const Scene& scene) {
  hash.add(scene.floor_z_m);
  hash.add(scene.is_lit);
  for (const Room& room : scene.rooms) {
    hash.add(room.id + "\n" + room.type);
    hash.add(room.height_m);
    hash.add(room.polygon);
  }
  for (const StartPose& start : scene.starts) {
    hash.add(start.position.data(), sizeof(double) * 2);
    hash.add(start.yaw_rad);
  }
  hash.add(scene.tour);
}

std::string hexadecimal(std::uint64_t value) {
  std::string text;
  for (int shift = 60; shift >= 0; shift -= 4) text += "0123456789abcdef"[value >> static_cast<unsigned>(shift) & 15U];
  return text;
}

std::optional<std::vector<std::uint8_t>> read_light(const std::string& file, std::size_t size) {
  std::string reason;
  auto bytes = files::read_file(file, reason);
  if (!bytes || bytes->size() != size + kChecksumBytes) return std::nullopt;
  std::uint32_t checksum = 0;
  std::memcpy(&checksum, bytes->data() + size, kChecksumBytes);
  bytes->resize(size);
  if (files::crc32(*bytes) != checksum) return std::nullopt;
  return bytes;
}

/// Hash of everything on which the light depends.
std::uint64_t light_key(const Scene& scene, const SceneRaycaster& raycaster) {
  Hash hash;
  hash.add(kBakeVersion);
  hash.add(std::string(raycaster.instruction_set()));
  add_geometry(hash, scene);
  add_holes(hash, scene);
  return hash.value();
}

}  // namespace

std::uint64_t scene_hash(const Scene& scene) {
  Hash hash;
  add_geometry(hash, scene);
  hash.add(scene.mesh.texture_coordinates);
  hash.add(scene.mesh.colors);
  for (const auto& material : scene.mesh.materials) {
    hash.add(&material.color, sizeof material.color);
    hash.add(material.texture);
  }
  for (const auto& texture : scene.mesh.textures) hash.add(texture->pixels);
  for (const auto& instance : scene.instances) {
    hash.add(instance.id);
    hash.add(instance.class_id);
  }
  for (const auto& label : scene.labels.labels()) hash.add(std::to_string(label.id) + label.name);
  add_plan(hash, scene);
  return hash.value();
}

std::vector<std::uint8_t> cached_light(const Scene& scene, const SceneRaycaster& raycaster, int threads,
                                       const std::filesystem::path& folder) {
  if (folder.empty() || !scene.is_lit) return bake_light(scene, raycaster, threads);
  const auto file = (folder / (hexadecimal(light_key(scene, raycaster)) + kExtension)).string();
  if (auto light = read_light(file, 3 * scene.mesh.triangles.size())) return *light;
  auto light = bake_light(scene, raycaster, threads);
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  auto bytes = light;
  bytes.resize(light.size() + kChecksumBytes);
  const std::uint32_t checksum = files::crc32(light);
  std::memcpy(bytes.data() + light.size(), &checksum, kChecksumBytes);
  static_cast<void>(files::replace_file(file, bytes));  // when it fails, the next start only takes longer
  files::keep_newest(folder, kExtension, kKept_bytes);
  return light;
}

}  // namespace lapis::simulator
