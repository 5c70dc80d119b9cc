#pragma once

#include <cstdint>
#include <vector>

#include "simulator/core/render/raycaster.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// Light at the three corners of every triangle (3 * triangle + corner) of a scene's mesh as the factor, in 1/255, by
/// which it dims an sRGB colour. Ambient light with
/// occlusion within 1.2 m, lamps with shadows, and a floor, so that nothing is black; both sides of a surface are tried
/// and the brighter one counts, because models do not agree on which side is out. It does not depend on where it is
/// seen from, so features stay where they are. All corners use one set of directions, so it adds no texture of its
/// own. Empty for a scene that is not lit. Threads share the work; the result does not depend on their number.
std::vector<std::uint8_t> bake_light(const Scene& scene, const SceneRaycaster& raycaster, int threads);

}  // namespace lapis::simulator
