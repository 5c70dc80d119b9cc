#include "simulator/core/furniture/parametric_furniture.hpp"

#include "simulator/core/furniture/furniture_classes.hpp"

namespace lapis::simulator {
namespace {

void block(Workshop& s) { s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0, s.h, s.wood()); }

constexpr FurnitureClass kOther{"", 0.5, 0.5, 0.5, block};

const FurnitureClass& class_of(const std::string& name) {
  for (const auto& classes : {movable_classes(), fixture_classes()}) {
    for (const FurnitureClass& candidate : classes) {
      if (candidate.name == name) return candidate;
    }
  }
  return kOther;
}

}  // namespace

Eigen::Vector3d default_size_m(const std::string& class_name) {
  const FurnitureClass& found = class_of(class_name);
  return {found.width_m, found.depth_m, found.height_m};
}

Mesh make_furniture(const std::string& class_name, const Eigen::Vector3d& size_m, std::uint64_t variant,
                    TextureLibrary& textures) {
  Mesh mesh;
  Workshop workshop(mesh, size_m, variant, textures);
  class_of(class_name).make(workshop);
  fit_to_box(mesh, size_m);
  return mesh;
}

}  // namespace lapis::simulator
