#include "simulator/core/validation/validate.hpp"

#include <algorithm>

#include "simulator/core/validation/content_checks.hpp"
#include "simulator/core/validation/drive_checks.hpp"
#include "simulator/core/validation/items.hpp"

namespace lapis::simulator {

std::vector<Check> validate(const World& world, const ValidationConfig& config, const Progress& progress) {
  const Scene& scene = world.scene();
  const NavMap& map = world.nav_map();
  const double radius_m = config.tour.path.radius_m;
  std::vector<Check> checks;
  progress("paths of the robot");
  checks.push_back(check_starts(scene, map, radius_m));
  checks.push_back(check_rooms(scene, map, radius_m));
  checks.push_back(check_tour(scene, map, config.tour));
  checks.push_back(check_doors(scene, map));
  checks.push_back(check_corridors(scene, map));
  checks.push_back(list_loops(scene, map, radius_m));
  const Inventory inventory = take_inventory(scene);
  progress("what holds the items");
  checks.push_back(check_floating(scene, inventory));
  progress("space of the items");
  checks.push_back(check_overlaps(scene, inventory));
  checks.push_back(check_walls(scene, inventory));
  checks.push_back(list_panes(scene));
  progress("classes");
  checks.push_back(count_classes(scene, inventory));
  checks.push_back(check_features(scene, measure_features(world, config.features, progress)));
  return checks;
}

bool passes(const std::vector<Check>& checks) {
  return std::none_of(checks.begin(), checks.end(), [](const Check& check) { return check.verdict == Verdict::kFail; });
}

}  // namespace lapis::simulator
