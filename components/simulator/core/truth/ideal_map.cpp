#include "simulator/core/truth/ideal_map.hpp"

#include <stdexcept>

namespace lapis::simulator {

IdealMap::IdealMap(const IdealMapConfig& config) : config_(config), map_(config.resolution_m) {
  mapping::validate(config_.integration);
}

void IdealMap::add(const geometry::PinholeCamera& camera, const geometry::Pose& T_map_camera,
                   const geometry::DepthImage& depth, const geometry::LabelImage& labels) {
  std::string error;
  const auto frame = mapping::CompactFrame::make(camera, depth, &labels, config_.frame, error);
  if (!frame) throw std::runtime_error("ideal map: " + error);
  map_.add(mapping::compute_votes(*frame, T_map_camera, config_.integration, config_.resolution_m));
}

}  // namespace lapis::simulator
