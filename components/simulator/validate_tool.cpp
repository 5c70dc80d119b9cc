#include "simulator/validate_tool.hpp"

#include <array>
#include <filesystem>
#include <iomanip>
#include <iostream>

#include "common/files/atomic_file.hpp"
#include "simulator/core/frame_picture.hpp"
#include "simulator/core/validation/validate.hpp"
#include "simulator/set_up.hpp"

namespace lapis::simulator {
namespace {

constexpr std::array<const char*, 3> kVerdicts{"OK", "note", "FAIL"};  // in the order of Verdict
constexpr int kVerdictWidth = 6, kNameWidth = 11;

ValidationConfig validation_config(const SimulatorConfig& config) {
  ValidationConfig out;
  out.tour = tour_config(config);
  out.features.camera = pinhole_camera(config.robot.camera);
  out.features.mount = camera_mount(config.robot.camera);
  out.features.robot_radius_m = config.robot.radius_m;
  return out;
}

void print(const Scene& scene, const std::vector<Check>& checks) {
  std::cout << "scene " << scene.name << ": " << scene.mesh.triangles.size() << " triangles, " << scene.instances.size()
            << " instances, " << scene.rooms.size() << " rooms\n";
  for (const Check& check : checks) {
    std::cout << std::left << std::setw(kVerdictWidth) << kVerdicts.at(static_cast<std::size_t>(check.verdict))
              << std::setw(kNameWidth) << check.name << check.figures << '\n';
    for (const auto& line : check.details)
      std::cout << std::string(kVerdictWidth + kNameWidth + 2, ' ') << line << '\n';
  }
}

}  // namespace

int validate_scene(const SimulatorConfig& config) {
  if (!config.output_dir.empty()) files::require_writable_folder(config.output_dir, "simulator.output_dir");
  std::cerr << "opening the scene\n";
  const World world = open_world(config);
  for (const auto& warning : world.scene().warnings) std::cerr << "warning: " << warning << '\n';
  const ValidationConfig setting = validation_config(config);
  const auto checks = validate(world, setting, [](const std::string& line) { std::cerr << line << '\n'; });
  print(world.scene(), checks);
  const auto picture = std::filesystem::path(config.output_dir) / (world.scene().name + "_navmap.png");
  write_image(picture, draw_floor_plan(world, setting.tour));
  std::cout << (passes(checks) ? "all checks pass; " : "checks fail; ") << "map: " << picture.string() << '\n';
  return passes(checks) ? 0 : 1;
}

}  // namespace lapis::simulator
