#include "simulator/core/sensors.hpp"

#include <cmath>

namespace lapis::simulator {

Sensors::Sensors(const SensorConfig& config, const geometry::PinholeCamera&, std::uint64_t) : config_(config) {}

CameraImages Sensors::see(const RenderedFrame& ideal, const View&) const {
  CameraImages out{ideal.color, {ideal.depth.width, ideal.depth.height}, ideal.labels};
  for (std::size_t i = 0; i < ideal.depth.pixels.size(); ++i) {
    out.depth_mm.pixels[i] = static_cast<std::uint16_t>(std::lround(std::min(ideal.depth.pixels[i], 65.0F) * 1000.0F));
  }
  return out;
}
void Sensors::roll(const Motion&) {}
WheelSample Sensors::wheels(time::Time stamp) {
  pose_.stamp = stamp;
  return pose_;
}
ImuSample Sensors::imu(const Motion&, time::Time stamp) { return {stamp}; }

}  // namespace lapis::simulator
