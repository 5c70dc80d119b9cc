#pragma once

#include <optional>
#include <string>

#include "sensor_replay/core/tum_dataset.hpp"

namespace lapis::sensor_replay {

/// Length of the true path through the frames that have a pose [m]; empty when fewer than two have one.
std::optional<double> path_length_m(const TumDataset& dataset);

/// What a data set contains, for `--list`: a line per fact, ending in a newline.
std::string describe(const TumDataset& dataset);

}  // namespace lapis::sensor_replay
