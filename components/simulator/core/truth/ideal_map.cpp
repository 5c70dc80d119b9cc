#include "simulator/core/truth/ideal_map.hpp"

#include <stdexcept>

namespace lapis::simulator {

IdealMap::IdealMap(double resolution_m, const mapping::FrameSettings& frames)
    : frames_(mapping::of_reference(frames)), map_(resolution_m) {
  mapping::validate(frames_, resolution_m);
}

void IdealMap::add(const geometry::PinholeCamera& camera, const geometry::Pose& T_map_camera,
                   const geometry::DepthImage& depth, const geometry::LabelImage& labels) {
  std::string error;
  const auto frame = mapping::CompactFrame::make(camera, depth, &labels, {.stride = frames_.stride}, error);
  if (!frame) throw std::runtime_error("ideal map: " + error);
  map_.add(mapping::compute_votes(*frame, T_map_camera, frames_.integration, map_.resolution_m()));
}

}  // namespace lapis::simulator
