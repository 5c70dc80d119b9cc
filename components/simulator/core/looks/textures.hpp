#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// Names of all procedural surfaces: of walls and ceilings, of floors, and of furniture.
std::vector<std::string> texture_names();

bool is_texture(const std::string& name);

/// Length on a surface after which its texture repeats. [m]
double texture_period_m(const std::string& name);

/// A texture that repeats seamlessly, of at most 512 x 512 texels. It is a pure function of the arguments.
/// @param richness contrast: 0 is one colour, 1 natural, 2 doubled
/// @throws std::runtime_error for an unknown name
TextureImage make_texture(const std::string& name, std::uint64_t seed, double richness = 1.0);

/// A painting, poster or map; every motif is another picture, rich in corners. The longer side has 256 texels.
/// @param aspect width divided by height
TextureImage make_picture(std::uint64_t motif, double aspect, double richness = 1.0);

/// Makes every texture once; equal textures are shared.
class TextureLibrary {
 public:
  explicit TextureLibrary(double richness = 1.0) : richness_(richness) {}
  std::shared_ptr<const TextureImage> surface(const std::string& name, std::uint64_t seed);

 private:
  double richness_;
  std::map<std::pair<std::string, std::uint64_t>, std::shared_ptr<const TextureImage>> made_;
};

}  // namespace lapis::simulator
