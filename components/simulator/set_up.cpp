#include "simulator/set_up.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "common/mapping/file/label_list_file.hpp"
#include "simulator/core/assets/text_scan.hpp"
#include "simulator/core/generator/generate_building.hpp"
#include "simulator/core/loaders/load_scene.hpp"
#include "simulator/core/robot/tour_revisits.hpp"
#include "simulator/furniture.hpp"
#include "simulator/scene_yaml.hpp"

namespace lapis::simulator {
namespace {

namespace fs = std::filesystem;

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

/// Path of a bundled scene that is given by its name, or of a file or folder.
fs::path find_scene(const std::string& name) {
  if (name.empty()) {
    throw std::runtime_error("no scene given; call: lapis_simulator SCENE (bundled: " + joined(bundled_scenes()) + ")");
  }
  if (name.find('/') == std::string::npos) {
    fs::path bundled = config_folder() / "scenes" / (name + ".yaml");
    if (fs::exists(bundled)) return bundled;
  }
  if (fs::exists(name)) return name;
  throw std::runtime_error("scene " + name + ": no such file, no bundled scene (" + joined(bundled_scenes()) +
                           "), and no generated building (" + joined(building_kinds()) + ", with _SEED)");
}

Scene build(const SceneSpec& spec, const SimulatorConfig& config) {
  const auto catalog = std::make_shared<FurnitureCatalog>(config.world.furniture_folder);
  BuildOptions options;
  options.seed = static_cast<std::uint64_t>(config.seed);
  options.with_jitter = config.world.jitter;
  options.texture_richness = config.world.texture_richness;
  options.pictures_density = config.world.picture_density;
  return build_scene(spec, furniture_from(catalog), options);
}

fs::path light_folder(const SimulatorConfig& config) {
  return config.world.light_folder.empty() ? cache_folder("light") : fs::path(config.world.light_folder);
}

fs::path usual_labels() { return config_folder() / "labels" / "mpcat40.yaml"; }

std::uint16_t class_id(const Scene& scene, const std::string& name) {
  if (const auto id = scene.labels.id_of(name)) return *id;
  throw std::runtime_error("simulator.world.passable_classes: scene " + scene.name + " has no class " + name);
}

RobotConfig robot_config(const robot::RobotDescription& robot) {
  RobotConfig out;
  out.radius_m = robot.radius_m;
  out.max_speed_m_s = robot.max_speed_m_s;
  out.max_turn_rate_rad_s = robot.max_turn_rate_rad_s;
  out.lag_s = robot.drive_lag_s;
  out.max_acceleration_m_s2 = robot.max_acceleration_m_s2;
  out.max_turn_acceleration_rad_s2 = robot.max_turn_acceleration_rad_s2;
  out.command_timeout = time::Duration::from_seconds(robot.command_timeout_s);
  return out;
}

DepthModel depth_model(const std::string& name) {
  if (name == "kinect") return DepthModel::kKinect;
  if (name == "redwood") return DepthModel::kRedwood;
  return name == "realsense" ? DepthModel::kRealsense : DepthModel::kNone;
}

SensorConfig sensor_config(const SimulatorConfig& config) {
  const NoiseConfig& noise = config.noise;
  SensorConfig out;
  out.depth.model = depth_model(noise.depth);
  out.depth.noise_multiplier = noise.depth_multiplier;
  out.labels.model = noise.labels == "none" ? LabelModel::kNone : LabelModel::kDefault;
  if (!noise.color) out.color.sigma = 0.0;
  out.color.contrast = noise.contrast;
  out.color.shutter = noise.shutter;
  const Random random(static_cast<std::uint64_t>(config.seed), RandomStream::kWorld);
  out.odometry.scale = noise.odometry ? random.uniform(0, config.wheels.least_noise, config.wheels.most_noise) : 0.0;
  out.odometry.wheel_range = noise.odometry ? config.wheels.radius_error : 0.0;
  out.odometry.base_range = noise.odometry ? config.wheels.base_error : 0.0;
  out.odometry.turn_slip = noise.odometry ? config.wheels.turn_slip : 0.0;
  out.has_imu = config.imu;
  apply_drift(noise.drift == "hard" ? DriftPreset::kHard : DriftPreset::kNominal, out);
  return out;
}

}  // namespace

fs::path cache_folder(const std::string& name) {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0') {
    return fs::path(cache) / "lapis" / name;
  }
  const char* home = std::getenv("HOME");
  return home != nullptr && *home != '\0' ? fs::path(home) / ".cache/lapis" / name : fs::path();
}

fs::path config_folder() {
  const fs::path bin = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& folder : {bin / "../../../config", bin / "../share/lapis/config"}) {
    if (fs::exists(folder / "scenes")) return fs::canonical(folder);
  }
  throw std::runtime_error("no folder config/scenes belongs to " + bin.string() + "; name a scene by its file");
}

std::vector<std::string> bundled_scenes() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(config_folder() / "scenes")) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

SceneSpec generated_building(const BuildingName& name) {
  return generate_building(name, mapping::read_label_list(usual_labels()));
}

Scene open_scene(const SimulatorConfig& config) {
  if (const auto generated = parse_building_name(config.scene)) return build(generated_building(*generated), config);
  const fs::path file = find_scene(config.scene);
  if (file.extension() == ".yaml") return build(read_scene_yaml(file, usual_labels()), config);
  LoadOptions options;
  options.labels = mapping::read_label_list(usual_labels());
  return load_scene(file, options);
}

WorldConfig world_config(const Scene& scene, const SimulatorConfig& config) {
  WorldConfig out;
  out.threads = config.render_threads;
  out.light_folder = light_folder(config);
  for (const auto& name : config.world.passable_classes) out.passable_classes.push_back(class_id(scene, name));
  return out;
}

World open_world(const SimulatorConfig& config) {
  Scene scene = open_scene(config);
  const WorldConfig setting = world_config(scene, config);
  return World(std::move(scene), setting);
}

SimulationConfig simulation_config(const SimulatorConfig& config) {
  const auto& robot = config.robot;
  SimulationConfig out;
  out.seed = static_cast<std::uint64_t>(config.seed);
  out.camera_rate_hz = robot.camera.rate_hz;
  out.camera = pinhole_camera(robot.camera);
  out.mount = camera_mount(robot.camera);
  out.robot = robot_config(robot);
  out.drive = {config.wheels.speed_error, config.wheels.turn_error, config.wheels.command_noise};
  out.sensors = sensor_config(config);
  return out;
}

std::optional<StartPose> given_start(std::string_view text) {
  const auto x = to_number<double>(take_word(text)), y = to_number<double>(take_word(text)),
             yaw_deg = to_number<double>(take_word(text));
  const bool is_pose = x && y && yaw_deg && std::isfinite(*x + *y + *yaw_deg) && trimmed(text).empty();
  if (!is_pose) return std::nullopt;
  return StartPose{{*x, *y}, *yaw_deg * std::numbers::pi / 180.0};
}

StartPose start_pose(const World& world, const SimulatorConfig& config) {
  if (config.start.empty()) return draw_start(world, config.robot.radius_m, static_cast<std::uint64_t>(config.seed));
  return given_start(config.start).value();
}

TourConfig tour_config(const SimulatorConfig& config) {
  TourConfig tour;
  tour.path.radius_m = config.robot.radius_m;
  tour.max_speed_m_s = std::min(tour.max_speed_m_s, config.robot.max_speed_m_s);
  tour.max_turn_rate_rad_s = std::min(tour.max_turn_rate_rad_s, config.robot.max_turn_rate_rad_s);
  return tour;
}

std::optional<TourFollower> plan_tour(const World& world, const StartPose& start, const SimulatorConfig& config) {
  if (config.tour.empty()) return std::nullopt;
  const auto waypoints = config.tour == "bundled" ? world.scene().tour : read_tour_yaml(config.tour);
  if (waypoints.empty()) {
    throw std::runtime_error("scene " + world.scene().name + " has no tour; give a file with --tour FILE");
  }
  const TourConfig setting = tour_config(config);
  const NavMap& map = world.nav_map();
  Tour tour = plan_tour(map, start.position, waypoints, setting);
  if (config.tour_revisit_every_m > 0.0) {
    const auto more = with_revisits(map, tour, config.tour_revisit_every_m, setting.path);
    tour = plan_tour(map, start.position, more, setting);
  }
  return TourFollower(map, std::move(tour), setting);
}

}  // namespace lapis::simulator
