#include "tests/benchmark/slam/tour_recording.hpp"

#include <cmath>
#include <fstream>
#include <stdexcept>

#include "common/config/yaml.hpp"
#include "simulator/set_up.hpp"

namespace lapis::slam::benchmark {
namespace {

using simulator::OdometrySample;
using simulator::SimulatorConfig;

template <class Value>
void write(std::ostream& out, const Value* values, std::size_t count) {
  out.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(Value)));
}

template <class Value>
bool read(std::istream& in, Value* values, std::size_t count) {
  in.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(count * sizeof(Value)));
  return in.gcount() == static_cast<std::streamsize>(count * sizeof(Value));
}

geometry::GrayImage to_gray(const geometry::ColorImage& color) {
  geometry::GrayImage gray(color.width, color.height);
  for (std::size_t i = 0; i < gray.pixels.size(); ++i) {
    const auto& [r, g, b] = color.pixels[i];
    gray.pixels[i] = static_cast<std::uint8_t>((19595U * r + 38470U * g + 7471U * b + 32768U) >> 16);  // as slam does
  }
  return gray;
}

geometry::DepthImage to_metres(const geometry::Image<std::uint16_t>& depth_mm) {
  geometry::DepthImage depth(depth_mm.width, depth_mm.height);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    depth.pixels[i] = 1e-3F * static_cast<float>(depth_mm.pixels[i]);
  return depth;
}

void drive(const SimulatorConfig& config, const std::function<void(const TourFrame&)>& take) {
  const simulator::World world = simulator::open_world(config);
  const simulator::StartPose start = simulator::start_pose(world, config);
  auto tour = simulator::plan_tour(world, start, config);
  if (!tour) throw std::runtime_error("simulator.tour: a tour is needed, \"bundled\" or a file");
  simulator::Simulation simulation(world, simulator::simulation_config(config), start);
  const geometry::Pose T_base_camera = geometry::T_base_camera(camera_mount(config.robot.camera));
  std::optional<geometry::Pose> T_map_world;
  std::optional<simulator::DriveCommand> command;
  bool is_over = false;
  while (!is_over) {
    const simulator::SensorFrame sensed = simulation.next(command);
    if (!T_map_world) T_map_world = sensed.T_world_base.inverse();
    take({to_frame(sensed.stamp, pinhole_camera(config.robot.camera), sensed.images), sensed.odometry,
          *T_map_world * sensed.T_world_base * T_base_camera});
    command = tour->command(sensed.robot);
    if (const auto problem = tour->stalled(); !problem.empty()) throw std::runtime_error(problem);
    is_over = tour->is_finished() || (config.duration_s > 0.0 && sensed.stamp.seconds() >= config.duration_s);
  }
}

void write(std::ostream& out, const TourFrame& tour_frame) {
  const auto& [frame, odometry, T_start_camera] = tour_frame;
  const std::uint64_t count = odometry.size();
  write(out, &frame.stamp, 1);
  write(out, T_start_camera.matrix().data(), 16);
  write(out, &count, 1);
  write(out, odometry.data(), odometry.size());
  write(out, frame.gray.pixels.data(), frame.gray.pixels.size());
  std::vector<std::uint16_t> depth_mm;
  for (const float z : frame.depth.pixels) depth_mm.push_back(static_cast<std::uint16_t>(std::lround(1e3F * z)));
  write(out, depth_mm.data(), depth_mm.size());
}

bool read(std::istream& in, TourFrame& tour_frame) {
  auto& [frame, odometry, T_start_camera] = tour_frame;
  std::uint64_t count = 0;
  if (!read(in, &frame.stamp, 1)) return false;
  read(in, T_start_camera.matrix().data(), 16);
  read(in, &count, 1);
  odometry.resize(count);
  read(in, odometry.data(), odometry.size());
  read(in, frame.gray.pixels.data(), frame.gray.pixels.size());
  geometry::Image<std::uint16_t> depth_mm(frame.depth.width, frame.depth.height);
  if (!read(in, depth_mm.pixels.data(), depth_mm.pixels.size())) return false;
  frame.depth = to_metres(depth_mm);
  return true;
}

// One name for one tour: everything that the configuration says goes into it.
std::filesystem::path recording_of(const SimulatorConfig& config, const std::filesystem::path& folder) {
  SimulatorConfig copy = config;
  config::Schema schema;
  schema("simulator", copy);
  schema("robot", copy.robot);
  const std::size_t hash = std::hash<std::string>{}(config::to_yaml(schema));
  const std::string scene = std::filesystem::path(config.scene).stem().string();
  return folder / (scene + "_" + std::to_string(config.seed) + "_" + std::to_string(hash) + ".tour");
}

}  // namespace

geometry::Pose planar(const Eigen::Vector2d& position, double yaw_rad, double z_m) {
  return geometry::make_pose({position.x(), position.y(), z_m},
                             Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())));
}

geometry::Pose pose_of(const OdometrySample& reading) { return planar(reading.position, reading.yaw_rad); }

RgbdFrame to_frame(time::Time stamp, const geometry::PinholeCamera& camera, const simulator::CameraImages& images) {
  return {stamp, camera, to_gray(images.color), to_metres(images.depth_mm)};
}

RgbdFrame black_frame(time::Time stamp, const geometry::PinholeCamera& camera) {
  return {stamp, camera, geometry::GrayImage(camera.width, camera.height),
          geometry::DepthImage(camera.width, camera.height)};
}

TourConfig tour_config(const std::vector<std::string>& assignments, const std::vector<std::string>& worlds) {
  TourConfig tour;
  config::Schema schema;
  schema("simulator", tour.simulated);
  schema("robot", tour.simulated.robot);
  schema("slam", tour.slam);
  tour.simulated.tour = "bundled";
  for (const std::string& world : worlds) config::apply_file(schema, world);
  for (const std::string& assignment : assignments) config::apply_override(schema, assignment);
  config::check(schema);
  return tour;
}

void play_tour(const SimulatorConfig& config, const std::filesystem::path& folder,
               const std::function<void(const TourFrame&)>& take) {
  if (folder.empty()) return drive(config, take);
  const std::filesystem::path file = recording_of(config, folder);
  if (!std::filesystem::exists(file)) {
    std::filesystem::create_directories(folder);
    const std::filesystem::path part = file.string() + ".part";
    std::ofstream out(part, std::ios::binary);
    drive(config, [&](const TourFrame& frame) {
      write(out, frame);
      take(frame);
    });
    if (!out.flush()) throw std::runtime_error(part.string() + ": cannot be written; is the disk full?");
    std::filesystem::rename(part, file);
    return;
  }
  std::ifstream in(file, std::ios::binary);
  const auto camera = pinhole_camera(config.robot.camera);
  TourFrame frame{
      {{}, camera, geometry::GrayImage(camera.width, camera.height), geometry::DepthImage(camera.width, camera.height)},
      {},
      geometry::Pose::Identity()};
  while (read(in, frame)) take(frame);
}

}  // namespace lapis::slam::benchmark
