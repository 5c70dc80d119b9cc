#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace lapis::simulator {

/// White noise and random walk of the bias; ADIS16448 as in EuRoC [Burri et al., IJRR 2016]. All >= 0.
struct ImuNoiseConfig {
  double gyro_density = 1.6968e-4;       ///< [rad/s/sqrt(Hz)]
  double gyro_walk = 1.9393e-5;          ///< [rad/s2/sqrt(Hz)]
  double acceleration_density = 2.0e-3;  ///< [m/s2/sqrt(Hz)]
  double acceleration_walk = 3.0e-3;     ///< [m/s3/sqrt(Hz)]
};

struct ImuReading {
  Eigen::Vector3d turn_rate_rad_s{0, 0, 0};
  Eigen::Vector3d acceleration_m_s2{0, 0, 0};
  double turn_rate_variance = 0.0;     ///< of the white noise, every axis
  double acceleration_variance = 0.0;  ///< of the white noise, every axis
};

/// Biases begin at zero. Noise depends on the number of the reading alone.
class ImuNoise {
 public:
  ImuNoise(const ImuNoiseConfig& config, std::uint64_t seed) : config_(config), seed_(seed) {}

  /// @param period_s since the last reading, > 0
  ImuReading read(const Eigen::Vector3d& turn_rate_rad_s, const Eigen::Vector3d& acceleration_m_s2, double period_s);

 private:
  ImuNoiseConfig config_;
  std::uint64_t seed_;
  std::uint64_t readings_ = 0;
  Eigen::Vector3d turn_rate_bias_{0, 0, 0};
  Eigen::Vector3d acceleration_bias_{0, 0, 0};
};

}  // namespace lapis::simulator
