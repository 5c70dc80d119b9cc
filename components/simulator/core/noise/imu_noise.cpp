#include "simulator/core/noise/imu_noise.hpp"

#include <cmath>

#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {

ImuReading ImuNoise::read(const Eigen::Vector3d& turn_rate_rad_s, const Eigen::Vector3d& acceleration_m_s2,
                          double period_s) {
  const Random random(seed_, RandomStream::kImu, readings_++);
  const auto normal3 = [&random](std::uint64_t first) {
    return Eigen::Vector3d(random.normal(first), random.normal(first + 1), random.normal(first + 2));
  };
  // A white density sampled over a period: sigma = density / sqrt(dt); a walk grows by sigma = density * sqrt(dt).
  const double root = std::sqrt(period_s);
  turn_rate_bias_ += config_.gyro_walk * root * normal3(0);
  acceleration_bias_ += config_.acceleration_walk * root * normal3(3);
  const double gyro_sigma = config_.gyro_density / root, acceleration_sigma = config_.acceleration_density / root;
  return {turn_rate_rad_s + turn_rate_bias_ + gyro_sigma * normal3(6),
          acceleration_m_s2 + acceleration_bias_ + acceleration_sigma * normal3(9), gyro_sigma * gyro_sigma,
          acceleration_sigma * acceleration_sigma};
}

}  // namespace lapis::simulator
