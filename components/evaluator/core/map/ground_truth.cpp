#include "evaluator/core/map/ground_truth.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/files/atomic_file.hpp"
#include "common/mapping/file/map_file.hpp"
#include "evaluator/core/map/map_input.hpp"

namespace lapis::evaluator {
namespace {

constexpr double kMaxOffset_m = 0.01;
constexpr double kMaxTurn_rad = 0.001;

nlohmann::json read_json(const std::filesystem::path& file) {
  std::string problem;
  const auto bytes = files::read_file(file.string(), problem);
  if (!bytes) throw std::runtime_error(problem);
  return nlohmann::json::parse(*bytes);
}

KnownSpace read_space(const std::filesystem::path& file) {
  std::string problem;
  const auto map = mapping::load_map(file.string(), problem);
  if (!map) throw std::runtime_error(problem);
  return to_known_space(map->map, mapping::BeliefReader(map->sensor_model));
}

/// @param numbers translation, quaternion x y z w
geometry::Pose to_pose(const std::array<double, 7>& numbers) {
  const auto& [x, y, z, qx, qy, qz, qw] = numbers;
  const Eigen::Quaterniond rotation(qw, qx, qy, qz);
  geometry::Pose T = geometry::make_pose({x, y, z}, rotation);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-6) || !geometry::is_valid(T)) {
    throw std::runtime_error("T_map_world is no pose");
  }
  return T;
}

}  // namespace

std::optional<GroundTruth> load_ground_truth(const std::filesystem::path& folder, std::string& problem) {
  problem.clear();
  if (!std::filesystem::exists(folder / "mesh.lapis")) return std::nullopt;
  try {
    GroundTruth truth;
    truth.mesh = read_space(folder / "mesh.lapis");
    const auto with_margin = folder / "with_margin.lapis";
    if (std::filesystem::exists(with_margin)) truth.with_margin = read_space(with_margin);
    truth.top_classes = read_json(folder / "classes.json").at("top_classes").get<std::vector<std::uint16_t>>();
    truth.T_map_world = to_pose(read_json(folder / "rooms.json").at("T_map_world").get<std::array<double, 7>>());
    return truth;
  } catch (const std::exception& error) {
    problem = folder.string() + ": " + error.what();
    return std::nullopt;
  }
}

bool is_same_frame(const geometry::Pose& T_map_world, const geometry::Pose& other) {
  const geometry::Pose difference = T_map_world * other.inverse();  // between two map frames; the run is near both
  return difference.translation().norm() <= kMaxOffset_m &&
         geometry::rotation_angle(difference.linear()) <= kMaxTurn_rad;
}

}  // namespace lapis::evaluator
