#include "simulator/tum_export.hpp"

#include <cstdio>
#include <iostream>

#include "common/files/atomic_file.hpp"
#include "common/trajectory/trajectory.hpp"
#include "simulator/core/frame_picture.hpp"
#include "simulator/core/truth/truth_files.hpp"
#include "simulator/run_files.hpp"
#include "simulator/set_up.hpp"

namespace lapis::simulator {
namespace {

constexpr std::uint64_t kProgressFrames = 150;

std::string text(const char* format, auto... values) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

/// Writes each image when it is added, and the lists at the end.
class TumWriter {
 public:
  TumWriter(std::filesystem::path folder, const Scene& scene, const robot::CameraDescription& camera)
      : folder_(std::move(folder)) {
    for (const char* sub : {"rgb", "depth", "label"}) std::filesystem::create_directories(folder_ / sub);
    const auto model = pinhole_camera(camera);
    files::replace_text(folder_ / "camera.yaml",
                        text("width: %d\nheight: %d\nfx: %.17g\nfy: %.17g\ncx: %.17g\ncy: %.17g\n", model.width,
                             model.height, model.fx, model.fy, model.cx, model.cy) +
                            text("depth_scale: 1000\nfps: %.17g\ncamera_height: %.17g\npitch_down_deg: %.17g\n",
                                 camera.rate_hz, camera.height_m, camera.pitch_down_deg));
    std::string classes = "class_id,class\n";
    for (const auto& label : scene.labels.labels()) classes += std::to_string(label.id) + "," + label.name + "\n";
    files::replace_text(folder_ / "classes.csv", classes);
  }

  void add(const SensorFrame& frame, const geometry::Pose& T_world_camera) {
    const std::string name = text("%06d.png", static_cast<int>(frame.tick)),
                      stamp = text("%.9f", frame.stamp.seconds());
    write_image(folder_ / "rgb" / name, frame.images.color);
    write_image(folder_ / "depth" / name, frame.images.depth_mm);
    write_image(folder_ / "label" / name, frame.images.labels);
    rgb_ += stamp + " rgb/" + name + "\n";
    depth_ += stamp + " depth/" + name + "\n";
    both_ += stamp + " rgb/" + name + " " + stamp + " depth/" + name + "\n";
    truth_.push_back({frame.stamp, T_world_camera});
  }

  void finish() const {
    files::replace_text(folder_ / "rgb.txt", rgb_);
    files::replace_text(folder_ / "depth.txt", depth_);
    files::replace_text(folder_ / "associations.txt", both_);
    trajectory::write_trajectory(folder_ / "groundtruth.txt", truth_, "camera optical frame in the scene");
  }

 private:
  std::filesystem::path folder_;
  std::string rgb_, depth_, both_;
  trajectory::Trajectory truth_;
};

SimulatorConfig with_a_tour(SimulatorConfig config) {
  if (config.tour.empty()) config.tour = "bundled";
  return config;
}

}  // namespace

int export_tum(const SimulatorConfig& config) {
  const World world = open_world(config);
  const StartPose start = start_pose(world, config);
  auto tour = plan_tour(world, start, with_a_tour(config));
  Simulation simulation(world, simulation_config(config), start);
  TumWriter writer(config.export_dir, world.scene(), config.robot.camera);
  const auto truth = std::filesystem::path(config.export_dir) / "ground_truth";
  const mapping::MapDescription map = default_map(config);
  write_truth(world, start, config, map, truth);
  IdealMap ideal(map.resolution_m, map.frames);
  const geometry::Pose T_base_camera = geometry::T_base_camera(camera_mount(config.robot.camera));
  std::optional<DriveCommand> command;
  bool is_over = false;
  while (!is_over) {
    const SensorFrame frame = simulation.next(command);
    writer.add(frame, frame.T_world_base * T_base_camera);
    add_to(ideal, frame, world, start, config);
    command = tour->command(frame.robot);
    if (const auto problem = tour->stalled(); !problem.empty()) {
      throw std::runtime_error("scene " + world.scene().name + ": " + problem);
    }
    is_over = tour->is_finished() || (config.duration_s > 0.0 && frame.stamp.seconds() >= config.duration_s);
    if (frame.tick % kProgressFrames == 0) {
      std::cout << "frame " << frame.tick << ", waypoint " << tour->leg() << '\n' << std::flush;
    }
  }
  writer.finish();
  write_ideal_map(truth, world.scene(), ideal);
  std::cout << config.export_dir << '\n';
  return 0;
}

}  // namespace lapis::simulator
