#pragma once

#include "simulator/core/scene/scene.hpp"
#include "simulator/core/validation/items.hpp"
#include "simulator/core/validation/report.hpp"

namespace lapis::simulator {

/// Checks that nothing floats (find_floating).
Check check_floating(const Scene& scene, const Inventory& inventory);
/// Checks that no two items fill the same space (find_overlaps).
Check check_overlaps(const Scene& scene, const Inventory& inventory);
/// Checks that no item sticks through a wall, floor, or ceiling (find_protrusions).
Check check_walls(const Scene& scene, const Inventory& inventory);
/// Lists panes that a robot can run into: windows and mirrors that begin below 0.3 m. It never fails; the verdict is a
/// note when there are any, because depth cameras do not see glass.
Check list_panes(const Scene& scene);
/// Counts items, triangles, and surface per class. It never fails; the verdict is a note when fewer than 16 classes
/// have a surface of 0.5 m2.
Check count_classes(const Scene& scene, const Inventory& inventory);

}  // namespace lapis::simulator
