#pragma once

#include "slam/core/files/slam_file.hpp"

namespace lapis::slam::test {

/// A sound map of random numbers with a few features, landmarks (some dead), surface samples, edges and links for each
/// key-frame. The same arguments give the same map.
SlamFile sample_file(unsigned seed, std::size_t keyframes, int features = 4);

}  // namespace lapis::slam::test
