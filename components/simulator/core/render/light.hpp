#pragma once

#include <cstdint>
#include <vector>

#include "simulator/core/render/raycaster.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// Light at the three corners of every triangle (3 * triangle + corner) of a scene's mesh, as the factor, in 1/255, by
/// which it dims an sRGB colour. It is the sum of ambient light with occlusion within 1.2 m, lamps with shadows, and a
/// least value, so that nothing is black. The brighter side of a surface counts, because models do not agree on which
/// side is out. Light does not depend on the view, so features stay in place. All corners use one set of directions,
/// so light adds no texture of its own. The result is empty for a scene that is not lit, and does not depend on the
/// number of threads.
std::vector<std::uint8_t> bake_light(const Scene& scene, const SceneRaycaster& raycaster, int threads);

}  // namespace lapis::simulator
