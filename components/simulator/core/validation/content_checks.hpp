#pragma once

#include "simulator/core/scene/scene.hpp"
#include "simulator/core/validation/items.hpp"
#include "simulator/core/validation/report.hpp"

namespace lapis::simulator {

/// Nothing floats (find_floating).
Check check_floating(const Scene& scene, const Inventory& inventory);
/// No two items fill the same space (find_overlaps).
Check check_overlaps(const Scene& scene, const Inventory& inventory);
/// No item sticks through a wall, floor, or ceiling (find_protrusions).
Check check_walls(const Scene& scene, const Inventory& inventory);
/// Lists panes that nothing keeps a robot from: windows and mirrors that begin below 0.3 m. Never fails; a note when
/// there are any, because depth cameras do not see glass.
Check list_panes(const Scene& scene);
/// Counts items, triangles, and surface per class; a note when fewer than 16 classes have 0.5 m2 to be seen. Fails for
/// no scene.
Check count_classes(const Scene& scene, const Inventory& inventory);

}  // namespace lapis::simulator
