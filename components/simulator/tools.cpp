#include "simulator/tools.hpp"

#include <iostream>

#include "common/files/atomic_file.hpp"
#include "simulator/core/frame_picture.hpp"
#include "simulator/core/views.hpp"
#include "simulator/run_files.hpp"
#include "simulator/scene_yaml_writer.hpp"
#include "simulator/set_up.hpp"
#include "simulator/tum_export.hpp"
#include "simulator/validate_tool.hpp"

namespace lapis::simulator {
namespace {

constexpr int kViewsPerRoom = 2;
constexpr int kSheetColumns = 2;
constexpr int kSheetPicture_px = 960;

void print_warnings(const Scene& scene) {
  for (const auto& warning : scene.warnings) std::cerr << "warning: " << warning << '\n';
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(folder.string() + ": cannot be made a folder: " + error.message());
}

int write_snapshots(const SimulatorConfig& config) {
  const World world = open_world(config);
  print_warnings(world.scene());
  const std::filesystem::path folder(config.snapshot_dir);
  make_folder(folder);
  const auto camera = pinhole_camera(config.robot.camera);
  const auto mount = camera_mount(config.robot.camera);
  std::vector<geometry::ColorImage> pictures;
  std::vector<std::string> names;
  for (const auto& view : choose_views(world, camera, mount, config.robot.radius_m, kViewsPerRoom)) {
    const auto frame = world.renderer().render(camera, T_world_camera(world, mount, view.position, view.yaw_rad));
    pictures.push_back(side_by_side(frame, world.scene().labels));
    names.push_back(view.name);
    write_image(folder / (view.name + ".png"), pictures.back());
    std::cout << (folder / (view.name + ".png")).string() << '\n';
  }
  if (pictures.empty()) throw std::runtime_error("scene " + world.scene().name + ": the robot fits nowhere");
  write_image(folder / "sheet.png", contact_sheet(pictures, names, kSheetColumns, kSheetPicture_px));
  std::cout << (folder / "sheet.png").string() << '\n';
  return 0;
}

/// Writes one folder per resolution: the paper's 0.25 m, and two of fine maps.
int write_ground_truth(const SimulatorConfig& config) {
  const World world = open_world(config);
  print_warnings(world.scene());
  const StartPose start = start_pose(world, config);
  make_folder(config.truth_dir);
  for (const auto& [name, resolution_m] : {std::pair{"0.25", 0.25}, {"0.10", 0.10}, {"0.05", 0.05}}) {
    const auto folder = std::filesystem::path(config.truth_dir) / name;
    mapping::MapDescription map = default_map(config);
    map.resolution_m = resolution_m;
    write_truth(world, start, config, map, folder);
    std::cout << folder.string() << '\n' << std::flush;
  }
  return 0;
}

int print_generated(const SimulatorConfig& config) {
  BuildingName name = parse_building_name(config.generated_kind + '_' + std::to_string(*config.generated_seed)).value();
  name.has_panes = config.generates_panes;
  std::cout << to_scene_yaml(generated_building(name));
  return 0;
}

int print_credits(const SimulatorConfig& config) {
  const Scene scene = open_scene(config);
  print_warnings(scene);
  for (const auto& credit : scene.credits) {
    std::cout << credit.model << " by " << credit.author << ", " << credit.licence << '\n';
  }
  if (scene.credits.empty()) std::cout << "scene " << scene.name << " shows nothing that others have made\n";
  return 0;
}

}  // namespace

std::optional<int> run_scene_tool(const SimulatorConfig& config) {
  if (config.generated_seed) return print_generated(config);
  if (config.validate) return validate_scene(config);
  if (config.credits) return print_credits(config);
  if (!config.snapshot_dir.empty()) return write_snapshots(config);
  if (!config.truth_dir.empty()) return write_ground_truth(config);
  if (!config.export_dir.empty()) return export_tum(config);
  return std::nullopt;
}

}  // namespace lapis::simulator
