// How much of a map's labels survives the noise of the segmentation: on the tour of a scene, at two frames a second,
// maps of noisy frames at poses with an error of given size are compared with the map of ideal frames at true poses.
//   lapis_label_noise_calibration [SCENE]      default: apartment
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numbers>

#include "evaluator/core/map/iou.hpp"
#include "evaluator/core/map/map_input.hpp"
#include "simulator/core/simulation.hpp"
#include "simulator/run_files.hpp"
#include "simulator/set_up.hpp"

namespace {

using namespace lapis;
using namespace lapis::simulator;

constexpr double kPoseErrors_m[] = {0.0, 0.05, 0.10, 0.20};
constexpr std::uint64_t kEvery = 7;              // frames: about 2 Hz
constexpr double kTurnsOfError_rad_per_s = 0.1;  // the error changes its direction slowly
constexpr double kYawError_rad_per_m = 0.1;

struct Maps {
  explicit Maps(const IdealMap& empty) : true_labels(empty), noisy_labels(empty) {}
  IdealMap true_labels;
  IdealMap noisy_labels;
};

/// Pose of the camera as a localisation with a slow error of `size_m` would report it.
geometry::Pose with_error(const geometry::Pose& T, double size_m, double time_s) {
  const double phase = kTurnsOfError_rad_per_s * time_s;
  const Eigen::Vector3d shift(size_m * std::cos(phase), size_m * std::sin(phase), 0.0);
  const double yaw = kYawError_rad_per_m * size_m * std::cos(0.7 * phase);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  return geometry::make_pose(T.translation() + shift, turn * Eigen::Quaterniond(T.rotation()));
}

geometry::DepthImage to_metres(const geometry::Image<std::uint16_t>& depth_mm) {
  geometry::DepthImage out(depth_mm.width, depth_mm.height);
  for (std::size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = static_cast<float>(depth_mm.pixels[i]) * 1e-3F;
  return out;
}

double share_of_equal(const geometry::LabelImage& a, const geometry::LabelImage& b) {
  std::size_t equal = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) equal += a.pixels[i] == b.pixels[i];
  return static_cast<double>(equal) / static_cast<double>(a.pixels.size());
}

mapping::BeliefReader beliefs_of(const World& world) {
  mapping::SensorModel model;
  model.class_count = world.scene().labels.max_id();
  return mapping::BeliefReader(model);
}

void print_row(const char* name, const IdealMap& ideal, const std::vector<Maps>& maps, bool with_noisy_labels,
               const mapping::BeliefReader& beliefs) {
  const auto reference = evaluator::to_known_space(ideal.map(), beliefs).occupied;
  std::printf("| %s |", name);
  for (const auto& at_error : maps) {
    const auto& estimate = with_noisy_labels ? at_error.noisy_labels : at_error.true_labels;
    const auto iou = evaluator::semantic_iou(reference, evaluator::to_known_space(estimate.map(), beliefs).occupied);
    std::printf(" %.2f / %.2f |", iou.top_mean.value_or(0.0), iou.mean.value_or(0.0));
  }
  std::printf("\n");
}

void calibrate(const std::string& scene) {
  SimulatorConfig config;
  config.scene = scene;
  config.tour = "bundled";
  const World world = open_world(config);
  const StartPose start = start_pose(world, config);
  auto tour = plan_tour(world, start, config);
  Simulation simulation(world, simulation_config(config), start);
  const auto camera = pinhole_camera(config.robot.camera);
  const auto T_base_camera = geometry::T_base_camera(camera_mount(config.robot.camera));
  const mapping::MapDescription map = default_map(config);
  IdealMap ideal(map.resolution_m, map.frames);
  std::vector<Maps> maps(std::size(kPoseErrors_m), Maps(ideal));
  std::optional<DriveCommand> command;
  double accuracy_sum = 0.0;
  int used = 0;
  while (!tour->is_finished()) {
    const SensorFrame frame = simulation.next(command);
    command = tour->command(frame.robot);
    if (const auto problem = tour->stalled(); !problem.empty()) throw std::runtime_error(problem);
    if (frame.tick % kEvery != 0) continue;
    const geometry::Pose T = frame.T_world_base * T_base_camera;
    const auto depth = to_metres(frame.images.depth_mm);
    ideal.add(camera, T, frame.ideal_depth, frame.ideal_labels);
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const auto T_wrong = with_error(T, kPoseErrors_m[i], frame.stamp.seconds());
      maps[i].true_labels.add(camera, T_wrong, depth, frame.ideal_labels);
      maps[i].noisy_labels.add(camera, T_wrong, depth, frame.images.labels);
    }
    accuracy_sum += share_of_equal(frame.ideal_labels, frame.images.labels);
    ++used;
  }
  std::printf("%s: %d frames; share of pixels with the true label: %.2f\n", scene.c_str(), used, accuracy_sum / used);
  std::printf("IoU with the ideal map, mean of the 8 most frequent classes / of all\n\n| pose error |");
  for (const double error_m : kPoseErrors_m) std::printf(" %.0f cm |", 100.0 * error_m);
  std::printf("\n| --- | --- | --- | --- | --- |\n");
  print_row("true labels, noisy depth", ideal, maps, false, beliefs_of(world));
  print_row("default label noise", ideal, maps, true, beliefs_of(world));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    calibrate(argc > 1 ? argv[1] : "apartment");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
