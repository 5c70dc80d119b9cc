// Scene files, tours, label lists and model files. Some small buildings are built, too; it takes a thousand times as
// long.

#include <fstream>
#include <numeric>

#include "check_scene.hpp"
#include "common/mapping/file/label_list_file.hpp"
#include "segmenter/model_yaml.hpp"
#include "simulator/core/building/build_scene.hpp"
#include "simulator/core/building/floor_plan.hpp"
#include "simulator/core/scene/polygon.hpp"
#include "simulator/scene_yaml.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace lapis::simulator;

/// The file that is read, and the labels that it names.
class SceneFolder {
 public:
  SceneFolder() {
    std::filesystem::create_directories(folder_.path() / "labels");
    std::filesystem::create_directories(folder_.path() / "scenes");
    std::ofstream out(folder_.path() / "labels/mpcat40.yaml");
    out << "labels:\n";
    int id = 0;
    for (const char* name : {"wall", "floor", "ceiling", "door", "window", "lighting", "picture", "table", "chair"})
      out << "  - {id: " << ++id << ", name: " << name << "}\n";
  }
  std::filesystem::path write(const std::uint8_t* data, std::size_t size) const {
    std::filesystem::path file = folder_.path() / "scenes/a.yaml";
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return file;
  }

 private:
  lapis::test::TemporaryFolder folder_;
};

bool is_small(const SceneSpec& spec) {
  constexpr double kArea_m2 = 40.0, kSize_m = 2.0;
  const double area = std::accumulate(spec.rooms.begin(), spec.rooms.end(), 0.0, [&](double sum, const RoomSpec& room) {
    return sum + signed_area(room.polygon) * (1.0 + room.height_m.value_or(spec.height_m));
  });
  return area < kArea_m2 && spec.furniture.size() + spec.pictures.size() + spec.openings.size() < 6 &&
         std::all_of(spec.furniture.begin(), spec.furniture.end(),
                     [](const FurnitureSpec& item) { return !item.size_m || item.size_m->maxCoeff() < kSize_m; });
}

/// One input in 64, always the same ones [FNV-1a].
bool is_chosen(std::string_view text) {
  std::uint32_t hash = 2166136261U;
  for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619U;
  return hash % 64 == 0;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const SceneFolder folder;
  const auto file = folder.write(data, size);
  const auto attempt = [&](const auto& read) {
    try {
      read();
    } catch (const std::runtime_error& error) {
      if (std::string(error.what()).empty()) std::abort();
    }
  };
  attempt([&] { read_tour_yaml(file); });
  attempt([&] { lapis::mapping::read_label_list(file); });
  attempt([&] { lapis::segmenter::read_model_file(file); });
  attempt([&] {
    const SceneSpec spec = normalised(read_scene_yaml(file));
    plan_walls(spec);
    if (is_small(spec) && is_chosen({reinterpret_cast<const char*>(data), size})) fuzz::check(build_scene(spec, {}));
  });
  return 0;
}
