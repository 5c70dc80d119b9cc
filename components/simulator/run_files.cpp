#include "simulator/run_files.hpp"

#include <charconv>
#include <cstdio>
#include <numbers>

#include "common/config/yaml.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/crc32.hpp"
#include "common/files/kept_files.hpp"
#include "simulator/core/full_map.hpp"
#include "simulator/core/truth/truth_files.hpp"
#include "simulator/core/truth/voxel_truth.hpp"
#include "simulator/core/views.hpp"
#include "simulator/set_up.hpp"

namespace lapis::simulator {
namespace {

/// Pose of base_link at the start, which is the origin of the run's frame `map`.
geometry::Pose T_world_start(const World& world, const StartPose& start) {
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(start.yaw_rad, Eigen::Vector3d::UnitZ()));
  return geometry::make_pose({start.position.x(), start.position.y(), world.scene().floor_z_m}, rotation);
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

/// The shortest text that is read back as the same number.
std::string exact(double value) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// Writes full.lapis, and takes it from the user's cache when an earlier run made it.
void write_full_truth(const World& world, const geometry::Pose& T_world_base, const SimulatorConfig& config,
                      const mapping::MapDescription& map, const std::filesystem::path& folder,
                      const std::stop_token& cancelled) {
  constexpr const char* kExtension = ".lapis";
  constexpr std::uintmax_t kKept_bytes = 256U << 20U;
  const FullMapConfig full{
      map.resolution_m,      map.frames, pinhole_camera(config.robot.camera), camera_mount(config.robot.camera),
      config.robot.radius_m, cancelled};
  const std::string text = made_of(world, T_world_base, full);
  const auto target = folder / "full.lapis", cache = cache_folder("full_maps");
  const auto name = std::to_string(files::crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
  const auto kept = cache / (name + kExtension);
  if (const auto bytes = cache.empty() ? std::nullopt : read_full_map(kept, text)) {
    if (const auto problem = files::replace_file(target.string(), *bytes)) throw std::runtime_error(*problem);
    return;
  }
  const IdealMap made = make_full_map(world, T_world_base, full);
  if (cancelled.stop_requested()) return;
  write_full_map(target, world.scene(), made, text);
  if (cache.empty()) return;
  std::error_code ignored;  // without the cache the next run only takes longer
  std::filesystem::create_directories(cache, ignored);
  std::string problem;
  if (const auto bytes = files::read_file(target.string(), problem)) {
    static_cast<void>(files::replace_file(kept.string(), *bytes));
  }
  files::keep_newest(cache, kExtension, kKept_bytes);
}

std::string hexadecimal(std::uint64_t value) {
  char text[40];
  std::snprintf(text, sizeof text, "\"%016llx\"", static_cast<unsigned long long>(value));
  return text;
}

}  // namespace

std::string to_yaml(const RunSummary& summary, const World& world, const StartPose& start,
                    const SimulatorConfig& config) {
  std::string text = "scene: " + config::quoted(world.scene().name) + "\n";
  text += "scene_hash: " + hexadecimal(world.hash()) + "\n";
  text += "seed: " + std::to_string(config.seed) + "\n";
  text += "start: \"" + exact(start.position.x()) + " " + exact(start.position.y()) + " " +
          exact(start.yaw_rad * 180.0 / std::numbers::pi) + "\"  # as simulator.start\n";
  text += std::string("instruction_set: ") + world.raycaster().instruction_set() + "\n";
  text += "mode: " + config.mode + "\n";
  text += "exit_reason: " + config::quoted(summary.exit_reason) + "\n";
  text += "frames: " + std::to_string(summary.frames) + "\n";
  text += "simulated_s: " + number(summary.simulated_s) + "\n";
  text += "wall_s: " + number(summary.wall_s) + "\n";
  text += "real_time_factor: " + number(summary.simulated_s / std::max(summary.wall_s, 1e-3)) + "\n";
  text += "collisions: " + std::to_string(summary.collisions) + "\n";
  text += "hardest_push_m_s: " + number(summary.hardest_push_m_s) + "  # speed towards what was touched\n";
  if (summary.planner) {
    text += "planner_state: " + summary.planner->state + "\n";
    text += "planner_reason: " + config::quoted(summary.planner->reason) + "\n";
  }
  text += "participants:  # CPU time [ms]\n";
  for (const auto& [name, cpu_ms] : summary.cpu_ms) text += "  " + name + ": " + number(cpu_ms) + "\n";
  text += "demoted: {";
  for (const auto& [name, tick] : summary.demoted) {
    text += (text.back() == '{' ? "" : ", ") + name + ": " + std::to_string(tick);
  }
  text += "}  # participants without which the run continued, from which tick on\n";
  return text;
}

std::filesystem::path truth_folder(const SimulatorConfig& config) {
  return std::filesystem::path(config.output_dir) / "ground_truth";
}

mapping::MapDescription default_map(const SimulatorConfig& config) {
  mapping::MapDescription out;
  out.frames.integration.max_range_m = config.robot.sensing_range_m;
  return out;
}

void add_to(IdealMap& ideal, const SensorFrame& frame, const World& world, const StartPose& start,
            const SimulatorConfig& config) {
  const geometry::Pose T_map_base = T_map_world(T_world_start(world, start)) * frame.T_world_base;
  ideal.add(pinhole_camera(config.robot.camera), T_map_base * T_base_camera(camera_mount(config.robot.camera)),
            frame.ideal_depth, frame.ideal_labels);
}

void write_truth(const World& world, const StartPose& start, const SimulatorConfig& config,
                 const mapping::MapDescription& map, const std::filesystem::path& folder,
                 const std::stop_token& cancelled) {
  TruthConfig truth;
  truth.cancelled = cancelled;
  truth.resolution_m = map.resolution_m;
  truth.sensing_range_m = config.robot.sensing_range_m;
  truth.robot_radius_m = config.robot.radius_m;
  truth.margin_m = config.planner_margin_m;
  truth.camera = pinhole_camera(config.robot.camera);
  truth.mount = camera_mount(config.robot.camera);
  truth.threads = config.render_threads;
  const auto T = T_world_start(world, start);
  const auto volumes = make_voxel_truth(world.scene(), world.raycaster(), world.nav_map(), T, truth);
  if (!cancelled.stop_requested()) write_scene_truth(folder, world.scene(), world.nav_map(), T, volumes);
  if (config.full_map) write_full_truth(world, T, config, map, folder, cancelled);
}

}  // namespace lapis::simulator
