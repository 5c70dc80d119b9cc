#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "simulator/core/render/raycaster.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// Images of an ideal RGB-D camera, and what they show. All images have the camera's size.
struct RenderedFrame {
  geometry::ColorImage color;                ///< empty when it was not asked for
  geometry::DepthImage depth;                ///< z-depth [m]; 0: nothing hit
  geometry::LabelImage labels;               ///< class ids; 0: nothing hit, or unlabelled
  geometry::Image<std::uint16_t> instances;  ///< instance ids; 0: nothing hit
  geometry::Image<float> cosines;            ///< |cos| of the angle between ray and surface normal; 0: nothing hit
};

struct RendererConfig {
  int threads = 1;  ///< at least 1; the images do not depend on it
};

/// Renders a scene. Light does not depend on the view, so that features stay in place.
class Renderer {
 public:
  /// @param light at the corners of every triangle (bake_light); empty: colours as they are
  Renderer(const Scene& scene, const SceneRaycaster& raycaster, const std::vector<std::uint8_t>& light,
           const RendererConfig& config = {});
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// @param T_world_camera pose of the optical frame (x right, y down, z forward)
  RenderedFrame render(const geometry::PinholeCamera& camera, const geometry::Pose& T_world_camera,
                       bool with_color = true) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lapis::simulator
