#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "simulator/core/assets/model.hpp"
#include "simulator/core/assets/zip_store.hpp"

namespace lapis::simulator {

/// Where the Debian package sweethome3d-furniture puts its libraries.
inline constexpr const char* kFurnitureFolder = "/usr/share/sweethome3d/furniture";

/// A piece of furniture of a library. Texts are UTF-8.
struct CatalogEntry {
  std::string id;  ///< as in the library: "Scopia#bed1"
  std::string name;
  std::string category;
  std::string model;  ///< file in the library
  std::string creator;
  std::string licence;              ///< of the library
  Eigen::Vector3d size_m{0, 0, 0};  ///< width, depth, height
  double elevation_m = 0.0;         ///< of its lowest point above the floor
  std::optional<double> top_m;  ///< height of the surface for other things above the lowest point, where it is known
  Eigen::Matrix3f model_rotation = Eigen::Matrix3f::Identity();  ///< applied to the file's coordinates first
  bool is_movable = true;
  bool is_door_or_window = false;
  std::size_t library = 0;  ///< number of the library in its catalogue
};

/// Entries of a library, in the order of their numbers, from its PluginFurnitureCatalog.properties.
/// @param file name that messages show
/// @throws std::runtime_error naming file and key when a value is missing or makes no sense
std::vector<CatalogEntry> parse_catalog(std::span<const std::uint8_t> properties, const std::string& file);

/// The reason why a model is not used, in one line.
struct FurnitureRefusal {
  std::string reason;
};

/// The furniture libraries (*.sh3f, zip archives of SweetHome3D) in a folder. They are read where they are; nothing is
/// copied. Reading from several threads at once is allowed.
class FurnitureCatalog {
 public:
  static constexpr std::size_t kMaxTriangles = 60'000;

  /// A folder that does not exist, or holds no libraries, gives an empty catalogue. When several libraries hold the
  /// same id, the first one by file name counts.
  /// @throws std::runtime_error naming file and remedy for libraries that are broken
  explicit FurnitureCatalog(const std::filesystem::path& folder);

  bool empty() const { return entries_.empty(); }
  /// The entry with this id; null when there is none. It is valid as long as the catalogue.
  const CatalogEntry* find(const std::string& id) const;
  /// All entries, sorted by file name of the library, then by number.
  std::vector<const CatalogEntry*> entries() const;
  /// Reads the model from its file, in every call, into the item frame: metres, z up, origin in the middle of the
  /// footprint at the lowest point, x along the width, y along the depth; the front looks along -y. bounds() has the
  /// width, depth and height of the catalogue; an extent that the file does not have (a flat rug) stays zero.
  /// Models of more than kMaxTriangles triangles, and files that are missing or broken, are refused.
  std::variant<Model, FurnitureRefusal> load(const CatalogEntry& entry, int max_texture_px = 512) const;

 private:
  std::vector<std::unique_ptr<ZipStore>> libraries_;
  std::vector<CatalogEntry> entries_;
};

}  // namespace lapis::simulator
