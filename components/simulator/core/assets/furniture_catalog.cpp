#include "simulator/core/assets/furniture_catalog.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "simulator/core/assets/java_properties.hpp"
#include "simulator/core/assets/obj.hpp"
#include "simulator/core/assets/text_scan.hpp"

namespace lapis::simulator {
namespace {

constexpr const char* kPropertiesFile = "PluginFurnitureCatalog.properties";

// The properties of one entry: "key#number".
class EntryProperties {
 public:
  EntryProperties(const std::map<std::string, std::string>& properties, std::string number, const std::string& file)
      : properties_(properties), number_(std::move(number)), file_(file) {}

  std::optional<std::string> find(const std::string& key) const {
    const auto found = properties_.find(key + "#" + number_);
    if (found == properties_.end()) return std::nullopt;
    return found->second;
  }

  std::string text(const std::string& key) const {
    auto value = find(key);
    if (!value || value->empty()) fail(key, "is missing");
    return *value;
  }

  std::optional<double> metres(const std::string& key) const {
    const auto value = find(key);
    if (!value) return std::nullopt;
    const auto centimetres = to_number<double>(trimmed(*value));
    if (!centimetres || !std::isfinite(*centimetres)) fail(key, "is no number of centimetres");
    return *centimetres / 100.0;
  }

  double positive_metres(const std::string& key) const {
    const auto value = metres(key);
    if (!value || *value <= 0) fail(key, "must be there and positive");
    return *value;
  }

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw std::runtime_error(file_ + ": " + key + "#" + number_ + " " + what + "; repair or remove this library");
  }

 private:
  const std::map<std::string, std::string>& properties_;
  std::string number_;
  const std::string& file_;
};

// Nine numbers, row by row.
Eigen::Matrix3f rotation(const EntryProperties& properties) {
  Eigen::Matrix3f result = Eigen::Matrix3f::Identity();
  const auto text = properties.find("modelRotation");
  if (!text) return result;
  std::string_view rest = *text;
  for (int i = 0; i < 9; ++i) {
    const auto number = to_float(take_word(rest));
    if (!number) properties.fail("modelRotation", "must be nine numbers");
    result(i / 3, i % 3) = *number;
  }
  return result;
}

CatalogEntry to_entry(const EntryProperties& properties, const std::string& licence) {
  CatalogEntry entry;
  entry.id = properties.text("id");
  entry.name = properties.text("name");
  entry.category = properties.text("category");
  entry.model = properties.text("model");
  entry.model.erase(0, entry.model.find_first_not_of('/'));
  entry.creator = properties.find("creator").value_or("");
  entry.licence = licence;
  entry.size_m = {properties.positive_metres("width"), properties.positive_metres("depth"),
                  properties.positive_metres("height")};
  entry.elevation_m = properties.metres("elevation").value_or(0.0);
  entry.top_m = properties.metres("dropOnTopElevation");
  if (entry.top_m && *entry.top_m < 0) entry.top_m = std::nullopt;
  entry.model_rotation = rotation(properties);
  entry.is_movable = properties.find("movable") != "false";
  entry.is_door_or_window = properties.find("doorOrWindow") == "true";
  return entry;
}

std::vector<std::filesystem::path> libraries_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator(folder, error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error)) {
    if (it->path().extension() == ".sh3f") files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// SweetHome3D has y up and the front along +z.
Eigen::Vector3f to_item_axes(const Eigen::Vector3f& p) { return {p.x(), -p.z(), p.y()}; }

}  // namespace

std::vector<CatalogEntry> parse_catalog(std::span<const std::uint8_t> properties, const std::string& file) {
  const auto values = parse_java_properties(properties);
  std::map<std::uint32_t, std::string> numbers;
  for (const auto& [key, value] : values) {
    if (!key.starts_with("id#")) continue;
    if (const auto number = to_number<std::uint32_t>(key.substr(3))) numbers.emplace(*number, key.substr(3));
  }
  const auto licence = values.find("license");
  std::vector<CatalogEntry> entries;
  for (const auto& [number, digits] : numbers) {
    entries.push_back(to_entry({values, digits, file}, licence == values.end() ? "" : licence->second));
  }
  return entries;
}

FurnitureCatalog::FurnitureCatalog(const std::filesystem::path& folder) {
  std::set<std::string> ids;
  for (const auto& file : libraries_in(folder)) {
    auto library = std::make_unique<ZipStore>(file);
    const auto properties = library->read(kPropertiesFile);
    if (!properties) {
      throw std::runtime_error(file.string() + ": no readable " + kPropertiesFile +
                               " in it; install the furniture library again");
    }
    for (auto& entry : parse_catalog(*properties, file.string())) {
      entry.library = libraries_.size();
      if (ids.insert(entry.id).second) entries_.push_back(std::move(entry));
    }
    libraries_.push_back(std::move(library));
  }
}

const CatalogEntry* FurnitureCatalog::find(const std::string& id) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) { return entry.id == id; });
  return found == entries_.end() ? nullptr : &*found;
}

std::vector<const CatalogEntry*> FurnitureCatalog::entries() const {
  std::vector<const CatalogEntry*> result;
  for (const auto& entry : entries_) result.push_back(&entry);
  return result;
}

std::variant<Model, FurnitureRefusal> FurnitureCatalog::load(const CatalogEntry& entry, int max_texture_px) const {
  try {
    Model model = read_obj(*libraries_.at(entry.library), entry.model, max_texture_px);
    const std::size_t triangles = model.mesh.triangles.size();
    if (triangles > kMaxTriangles) {
      return FurnitureRefusal{entry.id + ": " + std::to_string(triangles) + " triangles, more than " +
                              std::to_string(kMaxTriangles)};
    }
    for (auto& p : model.mesh.positions) p = to_item_axes(entry.model_rotation * p);
    fit_to_box(model.mesh, entry.size_m);
    const std::string problem = problem_of(model.mesh);
    if (!problem.empty()) return FurnitureRefusal{entry.id + ": " + problem};
    return model;
  } catch (const std::runtime_error& error) {
    return FurnitureRefusal{entry.id + ": " + error.what()};
  }
}

}  // namespace lapis::simulator
